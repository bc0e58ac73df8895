/* A cloth that touches itself: corners on triangles and edges on edges, kept a thickness
 * apart by inelastic impulses (Bridson, Fedkiw and Anderson 2002), from one act to the
 * next, which is some steps later.
 *
 * Each pair is looked at where it is now: the nearest points and the direction between
 * them; where it was after the last act if it may have crossed since. Along that direction
 * it must not be nearer than the thickness, nor come nearer. Pairs take their turns until
 * all agree. What a few turns don't settle is made sure of: parts stay apart on their
 * straight ways if some fixed direction parts them at the start and at the end; a pair for
 * which none is found moves as one, and so do all pairs that share its particles (their
 * impact zone).
 *
 * Most pairs need no look. The odometer of a particle is the sum of its ways from look to
 * look, less those of the whole cloth; two parts d apart stay so until their odometers
 * have gone on by d together. For the same reason the list of pairs lasts until a
 * particle is half its margin away from where it was found.
 *
 * All in double precision and in a fixed order, for one model at a time, so the result
 * depends on nothing but that model.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/contact.h"

#include <math.h>
#include <string.h>

#include "gst/math/vec3.h"
#include "gst/sim/contacttouch.h"

/* Pairs are listed when they are nearer than the thickness and this share of the mean
 * length of an edge. */
#define MARGIN 0.3
/* Most rounds in which each pair is parted once; most searches for pairs that touch, and
 * that cross, within one act. */
#define MAX_TURNS 10
#define MAX_LOOKS 4
#define MAX_ZONE_LOOKS 30
/* Share of the thickness by which pairs may come nearer while others are parted, before
 * touching pairs are searched for anew. */
#define RESERVE 0.125
/* Pairs that are too near by less than this share of the thickness wait for the next act. */
#define SETTLED 1e-3
/* A hit: a pair that will come nearer by this share of the thickness until the next act. */
#define HIT 0.25
/* Parts that are nearer than the thickness from the start are parted in this time, s. */
#define PARTING 0.01
/* No particle moves farther than this in a step, m. */
#define MAX_WAY 1e3

/* Particles that move as one. */
typedef struct
{
  guint n, n_held;
  gdouble mass, way[3], velocity[3];
} Zone;

struct _ClothContact
{
  const ClothContactMesh *mesh;
  gboolean single;
  ClothContactPairs pairs;
  gboolean listed;              /* the pairs are */
  gdouble *before;              /* where the particles were after the last act */
  gdouble *at_list;             /* when the pairs were listed */
  gdouble *away;                /* from there, m */
  gdouble *way;                 /* of each particle since the last act, m */
  gboolean looked;              /* in this act */
  gdouble *at_look;             /* where the particles were then */
  gdouble *odometer, *since;    /* at that look, and since, m */
  ClothContactTouch *touches;
  gsize n_touches, n_allocated;
  guint32 *zone;                /* of each particle: another one of its zone */
  Zone *zones;                  /* at their first particles */
};

/* @mesh: must outlive the contact
 * @single: positions are to be single precision numbers
 *
 * Returns: (transfer full): the contact of one model; reset it before its first act
 */
ClothContact *
cloth_contact_new (const ClothContactMesh * mesh, gboolean single)
{
  ClothContact *contact = g_new0 (ClothContact, 1);
  gsize n = mesh->n_particles;

  contact->mesh = mesh;
  contact->single = single;
  cloth_contact_pairs_init (&contact->pairs, mesh);
  contact->before = g_new0 (gdouble, 3 * n);
  contact->at_list = g_new0 (gdouble, 3 * n);
  contact->at_look = g_new0 (gdouble, 3 * n);
  contact->odometer = g_new0 (gdouble, n);
  contact->since = g_new0 (gdouble, n);
  contact->away = g_new0 (gdouble, n);
  contact->way = g_new0 (gdouble, n);
  contact->zone = g_new0 (guint32, n);
  contact->zones = g_new0 (Zone, n);
  return contact;
}

/* @contact: (nullable) (transfer full): a contact
 */
void
cloth_contact_free (ClothContact * contact)
{
  if (!contact)
    return;
  cloth_contact_pairs_clear (&contact->pairs);
  g_free (contact->before);
  g_free (contact->at_list);
  g_free (contact->at_look);
  g_free (contact->odometer);
  g_free (contact->since);
  g_free (contact->away);
  g_free (contact->way);
  g_free (contact->touches);
  g_free (contact->zone);
  g_free (contact->zones);
  g_free (contact);
}

/* @positions: of the particles; parts that cross there are left crossed
 *
 * Starts anew from these positions: what happened before is forgotten.
 */
void
cloth_contact_reset (ClothContact * contact, const gdouble * positions)
{
  gsize size = 3 * (gsize) contact->mesh->n_particles * sizeof *positions;

  memcpy (contact->before, positions, size);
  memcpy (contact->at_look, positions, size);
  contact->listed = contact->looked = FALSE;
}

/* Lengths of the particles' ways from @from to @to, less that of the whole cloth, which is
 * @mean. Returns the longest. */
static gdouble
measure (const ClothContact * contact, const gdouble * from, const gdouble * to,
    gdouble mean[3], gdouble * lengths)
{
  gsize n = contact->mesh->n_particles;
  gdouble longest = 0.;

  mean[0] = mean[1] = mean[2] = 0.;
  for (gsize i = 0; i < n; i++)
    for (gsize k = 0; k < 3; k++)
      mean[k] += to[3 * i + k] - from[3 * i + k];
  for (guint k = 0; k < 3; k++)
    mean[k] /= (gdouble) n;
  for (gsize i = 0; i < n; i++) {
    gdouble way[3];

    for (gsize k = 0; k < 3; k++)
      way[k] = to[3 * i + k] - from[3 * i + k] - mean[k];
    lengths[i] = sqrt (cloth_vec3_dot (way, way));
    longest = MAX (longest, lengths[i]);
  }
  return longest;
}

static gdouble
sum_of_four (const gdouble * values, const guint32 particle[4])
{
  return values[particle[0]] + values[particle[1]] + values[particle[2]] +
      values[particle[3]];
}

static void
add_touch (ClothContact * contact, const ClothContactTouch * touch)
{
  if (contact->n_touches == contact->n_allocated) {
    contact->n_allocated = MAX (256, 2 * contact->n_allocated);
    contact->touches =
        g_renew (ClothContactTouch, contact->touches, contact->n_allocated);
  }
  contact->touches[contact->n_touches++] = *touch;
}

/* Whether the parts may have crossed on their straight ways from before to @x. They have
 * not when a plane of one direction lies between them at both ends, as it then does at all
 * times between. Three directions are tried: that between the nearest points @now, that
 * before, and their mean. If none does, @now becomes what was before. */
static gboolean
crosses (const ClothContact * contact, const ClothContactPair * pair,
    const gdouble * x, ClothContactTouch * now)
{
  ClothContactTouch was;
  gdouble mean[3];

  if (sum_of_four (contact->way, pair->particle) < now->distance
      || (cloth_contact_pair_is_parted (pair, contact->before, now->normal)
          && cloth_contact_pair_is_parted (pair, x, now->normal)))
    return FALSE;
  cloth_contact_touch_look (pair, contact->before, &was);
  for (guint k = 0; k < 3; k++)
    mean[k] = was.normal[k] + now->normal[k];
  if (cloth_contact_pair_is_parted (pair, x, was.normal)
      || (cloth_contact_pair_is_parted (pair, contact->before, mean)
          && cloth_contact_pair_is_parted (pair, x, mean)))
    return FALSE;
  *now = was;
  return TRUE;
}

/* Lists the pairs that touch, that may touch soon and that may cross, by the present
 * positions. */
static void
look (ClothContact * contact, gdouble seconds, gdouble reserve,
    const gdouble * inverse_mass, const gdouble * x)
{
  ClothContactPairs *pairs = &contact->pairs;
  const gdouble *odometer = contact->odometer, *way = contact->way;
  gdouble open = MIN (seconds / PARTING, 1.), most = 0.;

  for (gsize i = 0; i < contact->mesh->n_particles; i++) {
    contact->odometer[i] += contact->since[i];
    most = MAX (most, odometer[i] + way[i]);
  }
  memcpy (contact->at_look, x, 3 * (gsize) contact->mesh->n_particles *
      sizeof *x);
  most = 4. * most + reserve;
  contact->n_touches = 0;
  for (gsize i = 0; i < pairs->n_pairs; i++) {
    const ClothContactPair *pair = &pairs->pairs[i];
    gdouble start, ahead, h = pair->thickness, spare, was[3], mass = 0.;
    gboolean may_cross;
    ClothContactTouch touch;

    if (pairs->limits[i] > most)
      continue;
    start = sum_of_four (odometer, pair->particle);
    /* as far as it went it may go on */
    ahead = sum_of_four (way, pair->particle) + reserve;
    if (start + ahead < pairs->limits[i])
      continue;
    cloth_contact_touch_look (pair, x, &touch);
    spare = touch.distance - h;
    /* a pair whose nearest points another pair has too is only kept from crossing */
    may_cross = !(ahead < touch.distance);
    if (!touch.acts)
      spare = MAX (spare, MIN (touch.distance, 0.25 * h + reserve));
    pairs->limits[i] = start + spare;
    if ((ahead < spare || !touch.acts) && !may_cross)
      continue;
    if (may_cross)
      touch.acts |= crosses (contact, pair, x, &touch);
    if (touch.distance < CLOTH_CONTACT_NEAR)
      continue;
    for (guint k = 0; k < 4; k++)
      mass += touch.weight[k] * touch.weight[k] *
          inverse_mass[pair->particle[k]];
    touch.mass = mass > 0. ? 1. / mass : 0.;
    cloth_contact_touch_between (&touch, contact->before, was);
    touch.least =
        h - (1. - open) * MAX (h - MAX (cloth_vec3_dot (touch.normal, was),
            0.), 0.);
    add_touch (contact, &touch);
  }
}

static void
take_turns (ClothContact * contact, gdouble friction, gdouble seconds,
    gdouble settled, const gdouble * inverse_mass, gdouble * x, gdouble * v)
{
  for (guint turn = 0; turn < MAX_TURNS; turn++) {
    gdouble worst = 0.;

    for (gsize i = 0; i < contact->n_touches; i++) {
      if (contact->touches[i].acts) {
        gdouble by =
            cloth_contact_touch_part (&contact->touches[i], contact->before,
            friction, seconds,
            inverse_mass, x, v);

        worst = MAX (worst, by);
      }
    }
    if (worst < settled)
      return;
  }
}

static guint32
zone_of (ClothContact * contact, guint32 particle)
{
  guint32 *zone = contact->zone;

  while (zone[particle] != particle)
    particle = zone[particle] = zone[zone[particle]];
  return particle;
}

/* Puts pairs that would cross into zones. FALSE when there are none. */
static gboolean
join_zones (ClothContact * contact, const gdouble * x, gboolean first)
{
  gboolean any = FALSE;

  for (gsize i = 0; i < contact->n_touches; i++) {
    const ClothContactTouch *touch = &contact->touches[i];
    ClothContactTouch now;

    cloth_contact_touch_look (touch->pair, x, &now);
    if (!crosses (contact, touch->pair, x, &now))
      continue;
    for (guint32 p = 0; first && !any && p < contact->mesh->n_particles; p++)
      contact->zone[p] = p;
    any = TRUE;
    for (guint k = 1; k < 4; k++) {
      guint32 a = zone_of (contact, touch->pair->particle[0]);
      guint32 b = zone_of (contact, touch->pair->particle[k]);

      contact->zone[MAX (a, b)] = MIN (a, b);
    }
  }
  return any;
}

/* Each zone moves with the mean velocity of its mass, or with its held particles. */
static void
move_zones (ClothContact * contact, const gdouble * inverse_mass, gdouble * x,
    gdouble * v)
{
  gsize n = contact->mesh->n_particles;

  memset (contact->zones, 0, n * sizeof *contact->zones);
  for (guint32 i = 0; i < n; i++) {
    Zone *zone = &contact->zones[zone_of (contact, i)];

    zone->n++;
    zone->n_held += inverse_mass[i] == 0.;
  }
  for (guint32 i = 0; i < n; i++) {
    Zone *zone = &contact->zones[zone_of (contact, i)];
    gboolean held = inverse_mass[i] == 0.;
    gdouble mass = held ? 1. : 1. / inverse_mass[i];

    if (zone->n_held > 0 && !held)
      continue;
    zone->mass += mass;
    for (gsize k = 0; k < 3; k++) {
      zone->way[k] += mass * (x[3 * i + k] - contact->before[3 * i + k]);
      zone->velocity[k] += mass * v[3 * i + k];
    }
  }
  for (guint32 i = 0; i < n; i++) {
    const Zone *zone = &contact->zones[zone_of (contact, i)];

    if (zone->n == 1 || inverse_mass[i] == 0.)
      continue;
    for (gsize k = 0; k < 3; k++) {
      x[3 * i + k] = contact->before[3 * i + k] + zone->way[k] / zone->mass;
      v[3 * i + k] = zone->velocity[k] / zone->mass;
    }
  }
}

typedef enum
{
  LOST,                         /* beyond all measure */
  KNOWN,                        /* what may touch was listed before */
  NEW                           /* it was listed now */
} Sight;

/* Brings the list of what may touch up to date with where everything is now. */
static Sight
update (ClothContact * contact, gdouble thickness, gdouble seconds,
    const gdouble * inverse_mass, const gdouble * x)
{
  gsize n = contact->mesh->n_particles;
  gdouble margin = MARGIN * contact->mesh->edge, reserve = RESERVE * thickness;
  gdouble mean[3], since;

  measure (contact, contact->before, x, mean, contact->way);
  since = measure (contact, contact->at_look, x, mean, contact->since);
  if (!(since < MAX_WAY))
    return LOST;
  if (contact->looked && 4. * since < reserve)
    return KNOWN;
  if (contact->listed
      && !(measure (contact, contact->at_list, x, mean, contact->away) <
          0.5 * margin))
    contact->listed = FALSE;
  if (!contact->listed) {
    cloth_contact_pairs_find (&contact->pairs, contact->before, x, thickness,
        margin);
    memcpy (contact->at_list, x, 3 * n * sizeof *x);
    memset (contact->odometer, 0, n * sizeof *contact->odometer);
    contact->listed = TRUE;
  }
  look (contact, seconds, reserve, inverse_mass, x);
  contact->looked = TRUE;
  return NEW;
}

/* Whether some pair would come much nearer than its thickness in the time @ahead. Contact
 * should then act sooner: a particle that is pushed far stretches the cloth about it. */
static gboolean
is_hit (const ClothContact * contact, gdouble ahead, const gdouble * x,
    const gdouble * v)
{
  for (gsize i = 0; i < contact->n_touches; i++) {
    const ClothContactTouch *touch = &contact->touches[i];
    gdouble apart[3], u[3];

    if (!touch->acts || !(touch->mass > 0.))
      continue;
    cloth_contact_touch_between (touch, x, apart);
    cloth_contact_touch_between (touch, v, u);
    if (cloth_vec3_dot (touch->normal,
            apart) + ahead * cloth_vec3_dot (touch->normal,
            u) < (1. - HIT) * touch->pair->thickness
        && cloth_vec3_dot (touch->normal, u) < 0.)
      return TRUE;
  }
  return FALSE;
}

/* @thickness: of the cloth, m
 * @friction: Coulomb's coefficient of cloth on cloth
 * @seconds: since the last act
 * @ahead: until the next one
 * @inverse_mass: of each particle, 1/kg; 0 where it is held
 * @x: (inout): positions of the particles, m
 * @v: (inout): their velocities, m/s
 *
 * Keeps what the model has done since the last act from going through itself. Nothing
 * that comes afterwards may move a particle before the next step does.
 *
 * Returns: whether it should act again after the next step and not wait
 */
gboolean
cloth_contact_act (ClothContact * contact, gdouble thickness, gdouble friction,
    gdouble seconds, gdouble ahead, const gdouble * inverse_mass, gdouble * x,
    gdouble * v)
{
  gsize n = contact->mesh->n_particles;
  Sight sight = NEW;

  contact->looked = FALSE;
  for (guint i = 0; i < MAX_LOOKS && sight == NEW; i++) {
    sight = update (contact, thickness, seconds, inverse_mass, x);
    if (sight == NEW)
      take_turns (contact, friction, seconds, SETTLED * thickness,
          inverse_mass, x, v);
  }
  for (guint i = 0; i < MAX_ZONE_LOOKS && sight != LOST; i++) {
    sight = update (contact, thickness, seconds, inverse_mass, x);
    if (sight == LOST || !join_zones (contact, x, i == 0))
      break;
    move_zones (contact, inverse_mass, x, v);
  }
  if (sight == LOST)
    return FALSE;
  for (gsize i = 0; contact->single && i < 3 * n; i++)
    x[i] = (gfloat) x[i];
  memcpy (contact->before, x, 3 * n * sizeof *x);
  return is_hit (contact, ahead, x, v);
}
