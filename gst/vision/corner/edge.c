/* Following the edge of a square from one of its corners to the next.
 *
 * On bent cloth the next corner is rarely where a straight line from the last two would
 * put it, but the edge between black and white leads there.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/corner/edge.h"

#include <math.h>

/* Samples on either side of an edge, between these shares of its length. */
#define SAMPLES 6
#define FROM 0.2f
#define TO 0.8f
/* Grey levels between the two sides of an edge below which it is noise. */
#define CONTRAST 10.0f
/* The weakest sample of an edge over the mean one. */
#define EVEN 0.25f
/* Samples on a circle around a corner. */
#define AROUND 32
/* Angle between the two edges of a square at a corner, rad. */
#define MIN_WEDGE 0.25f
#define MAX_WEDGE 2.8f
/* Angle between a wedge and where it is looked for, rad. */
#define MAX_OFF 1.2f
/* Pixels from step to step. */
#define STEP 1.0f
/* The edge is looked for at so many places to either side of where it is expected, this
 * far apart, px. */
#define ASIDE 2
#define BESIDE 0.7f
/* An edge ends where its contrast falls below this share of what it was. */
#define FADED 0.4f
/* Steps at the start, within the blur of the corner, in which it may be weak. */
#define CORNER_STEPS 3
/* Share of a step's sideways move that turns the direction. */
#define TURN 0.25f
/* A turn this sharp within TRAIL steps is the next corner, rad; it lies half way. */
#define SHARP 0.5f
#define TRAIL 6
/* Largest bend of an edge in all, rad. */
#define MAX_BEND 1.3f

/* Of a place known to lie between four pixels. */
static inline gfloat
bilinear_inside (const ClothImage * image, gfloat x, gfloat y)
{
  gint column = (gint) x, row = (gint) y;
  gfloat fx = x - (gfloat) column, fy = y - (gfloat) row;
  const guint8 *at = image->data + row * image->stride + column;

  return (1 - fy) * ((1 - fx) * at[0] + fx * at[1])
      + fy * ((1 - fx) * at[image->stride] + fx * at[image->stride + 1]);
}

/* Whether a square of this half width lies between the picture's pixels. */
static inline gboolean
is_inside (const ClothImage * image, gfloat x, gfloat y, gfloat reach)
{
  return x >= reach && y >= reach && x + reach < (gfloat) (image->width - 1)
      && y + reach < (gfloat) (image->height - 1);
}

/* @levels: what each grey level counts as, NULL: as itself */
static inline gint
nearest (const ClothImage * image, const guint8 * levels, gfloat x, gfloat y)
{
  const guint8 level = image->data[(gint) lrintf (y) * image->stride
      + (gint) lrintf (x)];

  return levels ? levels[level] : level;
}

/* Whether there are pixels this far from a place to both sides, with room for rounding. */
static inline gboolean
has_pixels (const ClothImage * image, gfloat x, gfloat y, gfloat nx, gfloat ny)
{
  nx = fabsf (nx) - 0.49f;
  ny = fabsf (ny) - 0.49f;
  return x >= nx && y >= ny && x + nx <= (gfloat) (image->width - 1)
      && y + ny <= (gfloat) (image->height - 1);
}

/* The contrast of the edge as seen by samples this far from the line. */
static inline gfloat
contrast_at (const ClothImage * image, const guint8 * levels, gfloat ax,
    gfloat ay, gfloat dx, gfloat dy, gfloat offset)
{
  gfloat scale = offset / sqrtf (dx * dx + dy * dy);
  gfloat nx = -dy * scale, ny = dx * scale;
  gint sum = 0, least = 255, most = -255;
  gfloat mean;

  /* If the samples at both ends are inside, so are all. */
  if (!has_pixels (image, ax + FROM * dx, ay + FROM * dy, nx, ny)
      || !has_pixels (image, ax + TO * dx, ay + TO * dy, nx, ny))
    return 0;
  for (gint k = 0; k < SAMPLES; k++) {
    gfloat t = FROM + (TO - FROM) * (gfloat) k / (SAMPLES - 1);
    gfloat x = ax + t * dx, y = ay + t * dy;
    gint d = nearest (image, levels, x + nx, y + ny)
        - nearest (image, levels, x - nx, y - ny);

    sum += d;
    least = MIN (least, d);
    most = MAX (most, d);
  }
  mean = (gfloat) sum / SAMPLES;
  if ((mean > CONTRAST && (gfloat) least > EVEN * mean)
      || (mean < -CONTRAST && (gfloat) most < EVEN * mean))
    return mean;
  return 0;
}

static inline gfloat
contrast_between (const ClothImage * image, const guint8 * levels, gfloat ax,
    gfloat ay, gfloat bx, gfloat by)
{
  gfloat dx = bx - ax, dy = by - ay, length = sqrtf (dx * dx + dy * dy);
  /* Near the line, for squares seen obliquely; farther off, for bent edges. */
  gfloat contrast = contrast_at (image, levels, ax, ay, dx, dy,
      CLAMP (0.2f * length, 1.2f, 2.5f));

  if (contrast == 0 && length > 14)
    contrast = contrast_at (image, levels, ax, ay, dx, dy, 0.2f * length);
  return contrast;
}

/* @image: the picture
 * @ax: column of one end, px
 * @ay: row of it
 * @bx: column of the other end
 * @by: row of it
 *
 * Whether black lies on one side and white on the other of a line, all the way between two
 * corners.
 *
 * Returns: mean difference of grey levels, positive if the bright side is the one reached
 *   by a turn from x towards y, negative if it is the other one, 0 if there is no such edge
 */
gfloat
cloth_edge_contrast (const ClothImage * image, gfloat ax, gfloat ay,
    gfloat bx, gfloat by)
{
  return contrast_between (image, NULL, ax, ay, bx, by);
}

/* @image: the picture
 * @levels: (array fixed-size=256): what each grey level counts as
 * @ax: column of one end, px
 * @ay: row of it
 * @bx: column of the other end
 * @by: row of it
 *
 * As cloth_edge_contrast() of the picture in these levels, which need not be made.
 *
 * Returns: as cloth_edge_contrast()
 */
gfloat
cloth_edge_contrast_in_levels (const ClothImage * image,
    const guint8 levels[256], gfloat ax, gfloat ay, gfloat bx, gfloat by)
{
  return contrast_between (image, levels, ax, ay, bx, by);
}

/* Sines of the samples' angles; a quarter farther on, their cosines. */
static const gfloat circle[AROUND + AROUND / 4] = {
  0, 0.19509032f, 0.38268343f, 0.55557023f, 0.70710678f, 0.83146961f,
  0.92387953f, 0.98078528f, 1, 0.98078528f, 0.92387953f, 0.83146961f,
  0.70710678f, 0.55557023f, 0.38268343f, 0.19509032f, 0, -0.19509032f,
  -0.38268343f, -0.55557023f, -0.70710678f, -0.83146961f, -0.92387953f,
  -0.98078528f, -1, -0.98078528f, -0.92387953f, -0.83146961f, -0.70710678f,
  -0.55557023f, -0.38268343f, -0.19509032f, 0, 0.19509032f, 0.38268343f,
  0.55557023f, 0.70710678f, 0.83146961f, 0.92387953f, 0.98078528f
};

/* Where a circle's samples cross @level between sample @k and the next, as a share of a
 * turn. */
static inline gfloat
crossing (const gfloat * at, gint k, gfloat level)
{
  gfloat here = at[k], next = at[(k + 1) % AROUND];

  return ((gfloat) k + (level - here) / (next - here)) / AROUND;
}

/* @image: the picture
 * @x: column of a corner, px
 * @y: row of it
 * @radius: of a circle that reaches no other corner, px
 * @black: whether the wedge looked for is dark
 * @towards: direction in which the wedge lies, roughly, rad from +x towards +y
 * @rays: (out) (array fixed-size=2): directions of the two edges that bound the wedge, the
 *   second one turned from the first towards +y
 * @contrast: (out): grey levels between dark and bright
 *
 * Finds the edges of the square that has a corner here, where they cross a circle.
 *
 * Returns: %FALSE when there is no such corner
 */
gboolean
cloth_edge_wedge (const ClothImage * image, gfloat x, gfloat y,
    gfloat radius, gboolean black, gfloat towards, gfloat rays[2],
    gfloat * contrast)
{
  const gfloat turn = 2 * (gfloat) G_PI;
  gfloat at[AROUND], least = 255, most = 0, middle, least_off = MAX_OFF;
  gboolean found = FALSE;

  if (!is_inside (image, x, y, radius + 0.01f))
    return FALSE;
  for (gint k = 0; k < AROUND; k++) {
    at[k] = bilinear_inside (image, x + radius * circle[k + AROUND / 4],
        y + radius * circle[k]);
    least = MIN (least, at[k]);
    most = MAX (most, at[k]);
  }
  if (most - least < CONTRAST)
    return FALSE;
  middle = 0.5f * (least + most);
  for (gint k = 0; k < AROUND; k++) {
    gint end = k, n = 0;
    gfloat from, to, off;

    /* A run begins where the next sample is of the colour and this one is not. */
    if ((at[k] < middle) == black || (at[(k + 1) % AROUND] < middle) != black)
      continue;
    do {
      end = (end + 1) % AROUND;
      n++;
    } while (n < AROUND && (at[(end + 1) % AROUND] < middle) == black);
    from = turn * crossing (at, k, middle);
    to = turn * crossing (at, end, middle);
    if (to < from)
      to += turn;
    off = fabsf (remainderf (0.5f * (from + to) - towards, turn));
    if (to - from < MIN_WEDGE || to - from > MAX_WEDGE || off > least_off)
      continue;
    least_off = off;
    rays[0] = from;
    rays[1] = to;
    found = TRUE;
  }
  *contrast = most - least;
  return found;
}

/* Grey levels by which the side ahead (turned from x towards y) is darker, 1.5 px from the
 * edge on both sides, at places beside (@x, @y) along the normal. FALSE outside the
 * picture. */
static inline gboolean
steps_across (const ClothImage * image, gfloat x, gfloat y, gfloat nx,
    gfloat ny, gfloat steps[2 * ASIDE + 1])
{
  gboolean inside = is_inside (image, x, y, ASIDE * BESIDE + 1.6f);

  for (gint o = -ASIDE; o <= ASIDE; o++) {
    gfloat px = x + (gfloat) o * BESIDE * nx;
    gfloat py = y + (gfloat) o * BESIDE * ny;
    gfloat ax = px + 1.5f * nx, ay = py + 1.5f * ny;
    gfloat bx = px - 1.5f * nx, by = py - 1.5f * ny;

    if (!inside && !(is_inside (image, ax, ay, 0)
            && is_inside (image, bx, by, 0)))
      return FALSE;
    steps[o + ASIDE] = bilinear_inside (image, bx, by)
        - bilinear_inside (image, ax, ay);
  }
  return TRUE;
}

/* @image: the picture
 * @x: column of the corner to start from, px
 * @y: row of it
 * @angle: direction in which the edge leaves it, rad from +x towards +y
 * @dark_ahead: whether the dark side is the one reached by a turn from x towards y
 * @contrast: grey levels across the edge
 * @longest: where to give up, px
 * @end_x: (out): column at which the edge ends
 * @end_y: (out): row of it
 * @end_angle: (out): direction in which it arrives there
 *
 * Follows an edge, which may bend, to its end.
 *
 * Returns: %FALSE when it has no end within reach
 */
gboolean
cloth_edge_walk (const ClothImage * image, gfloat x, gfloat y, gfloat angle,
    gboolean dark_ahead, gfloat contrast, gfloat longest, gfloat * end_x,
    gfloat * end_y, gfloat * end_angle)
{
  gfloat sign = dark_ahead ? 1.0f : -1.0f, start = angle;
  gfloat last_x = x, last_y = y, usual = contrast;
  gfloat trail[TRAIL][3];       /* x, y, angle of the last steps */
  gint steps = (gint) (longest / STEP), weak = 0, walked = 0;

  for (gint k = 1; k <= steps; k++) {
    gfloat dx = cosf (angle), dy = sinf (angle), best = -G_MAXFLOAT;
    gfloat at[2 * ASIDE + 1], offset = 0;
    gint peak = 0;

    x += STEP * dx;
    y += STEP * dy;
    if (!steps_across (image, x, y, -dy, dx, at))
      return FALSE;
    for (gint o = -ASIDE; o <= ASIDE; o++) {
      at[o + ASIDE] *= sign;
      if (at[o + ASIDE] > best) {
        best = at[o + ASIDE];
        peak = o;
      }
    }
    if (k <= CORNER_STEPS)
      continue;
    if (best < FADED * usual) {
      /* Two weak steps in a row: noise alone makes single ones. */
      if (++weak == 2) {
        *end_x = last_x;
        *end_y = last_y;
        *end_angle = angle;
        return TRUE;
      }
      continue;
    }
    weak = 0;
    usual += 0.1f * (best - usual);
    offset = (gfloat) peak;
    if (peak > -ASIDE && peak < ASIDE) {
      gfloat l = at[peak + ASIDE - 1], r = at[peak + ASIDE + 1];
      gfloat bend = l - 2 * best + r;

      if (bend < 0)
        offset += CLAMP (0.5f * (l - r) / bend, -0.5f, 0.5f);
    }
    offset *= BESIDE;
    x -= 0.5f * offset * dy;
    y += 0.5f * offset * dx;
    angle += TURN * 0.5f * offset / STEP;
    last_x = x;
    last_y = y;
    if (walked >= TRAIL && fabsf (angle - trail[walked % TRAIL][2]) > SHARP) {
      const gfloat *corner = trail[(walked + TRAIL / 2) % TRAIL];

      *end_x = corner[0];
      *end_y = corner[1];
      *end_angle = trail[walked % TRAIL][2];
      return TRUE;
    }
    trail[walked % TRAIL][0] = x;
    trail[walked % TRAIL][1] = y;
    trail[walked % TRAIL][2] = angle;
    walked++;
    if (fabsf (angle - start) > MAX_BEND)
      return FALSE;
  }
  return FALSE;
}
