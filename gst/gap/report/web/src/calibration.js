// The page of a calibration, from what it carries.
// SPDX-License-Identifier: LGPL-2.1-or-later
import './style.css';
import './calibration.css';
import { css } from './colours.js';
import { niceLimit, read } from './data.js';
import { element, radios, section, table, whenShown } from './dom.js';
import { drawCorners, drawFrame, drawHistogram, drawMap, plane } from './plane.js';
import { RigView } from './rigscene.js';
import { figure } from './verdict.js';
import { fitted, known, number } from './words.js';

const FIRST = 6;
const HISTOGRAM = { width: 640, height: 480 };

const data = read('calibration-data');
const page = document.getElementById('calibration');
const used = data.views.filter((view) => known(view.rms));
const px = (value, digits = 3) => known(value) ? number(value, digits) + ' px' : '–';
// One corner, one axis.
const noise = (camera) => camera.rms / Math.SQRT2;
const centre = (map) => map[(map.length - 1) / 2];
const corners = (camera, map) => [0, camera.columns - 1, map.length - camera.columns, map.length - 1].map((i) => map[i]);
const worst = (camera, map) => corners(camera, map).includes(null) ? null : Math.max(...corners(camera, map));

function head() {
  const warnings = data.cameras.flatMap((camera) => camera.warnings.map((text) => `${camera.name}: ${text}.`));
  if (data.contradict) {
    warnings.unshift('The views contradict each other: don’t use this rig. Check that the board has these squares, the ' +
      'first one included, and is flat; take out the pictures of great RMS below.');
  }
  const [kind, pill] = data.contradict ? ['unexplained', 'Contradiction'] : warnings.length ? ['ambiguous', 'Warnings']
    : ['explained', 'No warnings'];
  const total = (name) => data.cameras.reduce((sum, camera) => sum + camera[name], 0);
  return element('header', { id: 'verdict', class: kind },
    element('p', { class: 'over' }, 'Calibration', ' ',
      element('span', { class: 'takes' }, data.cameras.map((camera) => camera.name).join(', '))),
    element('h1', {}, element('span', { class: 'pill' }, pill), ' ',
      `${data.cameras.length} ${data.cameras.length > 1 ? 'cameras' : 'camera'} from ${total('views')} views of a board of ` +
      `${data.columns} × ${data.rows} squares of ${number(1000 * data.square_m)} mm`),
    ...warnings.map((text) => element('p', { class: 'warning' }, text)),
    element('dl', { class: 'figures' },
      figure('RMS', px(data.rms), '', 'distance between corners seen and predicted'),
      figure('RMS left out', px(data.left_out_rms), '', 'on views that took no part in the fit'),
      figure('Variance', number(data.variance), '', 'of the residuals, over the expected one'),
      data.warp ? figure('Board', data.warp.map((warp) => number(1000 * warp, 2)).join(', ') + ' mm', '',
        `bent along rows and columns, ± ${data.warp_sd.map((sd) => number(1000 * sd, 1)).join(', ')} mm`) : null,
      figure('Corners', String(total('corners')), '', `${total('outliers')} of them outliers`)));
}

function cameras() {
  const rows = data.cameras.map((camera) => [
    [camera.name, element('small', {}, `${camera.width} × ${camera.height}, ${camera.lens}`)],
    ...[camera.parameters.slice(0, 2), camera.parameters.slice(2, 4), camera.parameters.slice(4)].map((list) =>
      list.map(({ name, value, sd }) => element('small', {}, `${name} ${fitted(value, sd)[0]} ± ${number(sd, 2)}`))),
    px(camera.rms), `${camera.views} of ${camera.pictures}`,
    [`${px(centre(camera.near), 2)}, ${px(worst(camera, camera.near), 2)}`,
      element('small', {}, `far: ${px(centre(camera.far), 2)}, ${px(worst(camera, camera.far), 2)}`)]]);
  return section('cameras', 'Cameras', 'What was found, with one standard deviation. It counts the noise of the corners only.',
    table('camera-table', 'Cameras', ['Camera', 'Focal length, px', 'Centre, px', 'Lens', 'RMS', 'Views',
      'Projection ±, centre and worst corner'], rows));
}

function certainty() {
  let chosen = 'near';
  const planes = data.cameras.map((camera) => plane(camera,
    `${camera.name}: boards were ${number(camera.distance, 2)} m away`,
    `Uncertainty of projections over the picture of ${camera.name}: ${px(centre(camera.near), 2)} in the centre, at the worst corner ${px(worst(camera, camera.near), 2)}`,
    (context, scale, width, height) => drawMap(context, camera[chosen], camera.columns, noise(camera), width, height)));
  const strip = element('span', { class: 'strip' });
  const stops = [];
  for (let i = 0; i <= 20; i++) stops.push(css(i / 20));
  strip.style.background = `linear-gradient(to right, ${stops.join(',')})`;
  return section('certainty', 'How certain a projection is',
    'One standard deviation, in pixels, of where a point that is known beside the boards appears in the picture, in the ' +
    'worst direction. Outside of the black line it is greater than the noise of one corner: bring the board there. ' +
    'Grey: the lens is not known.',
    radios('range', 'A point', [['near', 'as far as the boards'], ['far', 'infinitely far']], chosen, (value) => {
      chosen = value;
      planes.forEach((node) => node.redraw());
    }),
    element('div', { class: 'legend' }, element('span', { class: 'scale' }, strip,
      element('span', { class: 'ticks' }, ...['0.01', '0.1', '1', '10 px'].map((text) => element('span', {}, text))))),
    element('div', { class: 'planes' }, ...planes));
}

const times = (camera) => niceLimit([0.014 * camera.width / camera.rms]);

function residuals() {
  const planes = data.cameras.flatMap((camera, c) => {
    const views = used.filter((view) => view.camera === c);
    const values = views.flatMap((view) => [...view.dx, ...view.dy]);
    return [
      plane(camera, `${camera.name}: corners, and ${times(camera)} times their residuals`,
        `Where the corners were in the picture of ${camera.name}`, (context, scale, width, height) => {
          drawFrame(context, width, height);
          const ink = getComputedStyle(document.documentElement).getPropertyValue('--mark').trim();
          views.forEach((view) => drawCorners(context, view, scale, times(camera), ink));
        }),
      plane(HISTOGRAM, `${camera.name}: residuals of both axes, and a Gaussian of ${px(noise(camera))}`,
        `Distribution of the residuals of ${camera.name}`,
        (context, scale, width, height) => drawHistogram(context, values, noise(camera), width, height))];
  });
  return section('residuals', 'Coverage and residuals',
    'Residuals are seen minus predicted. Neighbours that point the same way show a board that is not flat, or a lens that the ' +
    'model does not follow. Outliers are ringed; in the fit they have little weight.',
    element('div', { class: 'planes pairs' }, ...planes));
}

function pictures() {
  const worstFirst = [...used].sort((a, b) => b.rms - a.rms).filter((view) => view.picture);
  if (!worstFirst.length) return null;
  const figures = worstFirst.map((view) => {
    const camera = data.cameras[view.camera];
    const image = new Image();
    const node = plane(camera, [element('strong', {}, `${camera.name}, ${view.label}`), `: RMS ${px(view.rms)}`,
      view.outliers.length ? element('span', { class: 'bad' }, `, ${view.outliers.length} ${view.outliers.length > 1 ? 'outliers' : 'outlier'}`) : ''],
      `${camera.name}, ${view.label}, with the corners found`, (context, scale, width, height) => {
        drawFrame(context, width, height);
        if (image.complete && image.naturalWidth) context.drawImage(image, 0, 0, width, height);
        context.lineWidth = 1.4;
        drawCorners(context, view, scale, times(camera), '#1fd655');
      });
    image.addEventListener('load', () => node.redraw());
    image.src = 'data:image/jpeg;base64,' + view.picture;
    return node;
  });
  const rest = figures.slice(FIRST);
  rest.forEach((node) => { node.hidden = true; });
  const button = element('button', { type: 'button', class: 'action' }, `Show ${rest.length} more`);
  button.addEventListener('click', () => {
    rest.forEach((node) => { node.hidden = false; });
    button.remove();
  });
  return section('pictures', 'Pictures, the worst first',
    'The corners found, with their residuals, enlarged as above. Take out what is blurred or wrong.' +
    (worstFirst.length < used.length ? ` ${used.length - worstFirst.length} better ones are not in this page.` : ''),
    element('div', { class: 'planes' }, ...figures), rest.length ? button : null);
}

function views() {
  const rows = [...data.views].sort((a, b) => (b.rms ?? Infinity) - (a.rms ?? Infinity)).map((view) => [
    `${data.cameras[view.camera].name}, ${view.label}`, known(view.rms) ? px(view.rms) : 'not used', String(view.x.length),
    String(view.outliers.length)]);
  return section('views', 'All views', null, element('details', {}, element('summary', {}, `${data.views.length} views, the worst first`),
    table('view-table', 'Views', ['View', 'RMS', 'Corners', 'Outliers'], rows)));
}

function rig() {
  if (!data.placed) return null;
  const canvas = element('canvas', { id: 'rig', tabindex: '0', role: 'img',
    'aria-label': 'Cameras and boards in 3D. Arrow keys turn them, plus and minus zoom, Home resets.' });
  const names = element('div', { class: 'names', 'aria-hidden': 'true' });
  const stage = element('div', { class: 'stage' }, canvas, names);
  const most = Math.max(...used.map((view) => view.rms));
  const shadeOf = (pose) => 0.25 + 0.7 * Math.max(0, ...used.filter((view) => view.pose === pose).map((view) => view.rms)) / most;
  const home = element('button', { type: 'button' }, 'Reset view');
  try {
    const view = new RigView(canvas, names, data, shadeOf);
    home.addEventListener('click', () => view.reset());
    whenShown(stage, () => view.redraw());
  } catch {
    stage.replaceChildren(element('p', { class: 'missing' }, 'This browser shows no 3D: WebGL is missing or switched off.'));
    home.hidden = true;
  }
  return section('place', 'Cameras and boards',
    'Boards of the darker red fit worse. The grid is level in the rig’s world: z is up.',
    stage, element('div', { class: 'controls' }, home));
}

page.replaceChildren(...[head(), cameras(), certainty(), residuals(), pictures(), rig(), views()].filter(Boolean));
document.documentElement.dataset.ready = 'yes';
