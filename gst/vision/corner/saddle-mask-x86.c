/* The hyperbolic mask by AVX2 and AVX-512.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/corner/saddle-mask-x86.h"

#if defined (__x86_64__) && defined (__GNUC__)

#include <immintrin.h>
#include <string.h>

/* Columns left of a tile's first one that the differences may reach. */
#define MARGIN CLOTH_SADDLE_TILE_MARGIN

#define SUFFIX avx2
#define TARGET __attribute__((target ("avx2")))
#define LANES 16
#define VEC __m256i
#define LOAD(p) _mm256_loadu_si256 ((const __m256i *) (p))
#define STORE(p, v) _mm256_storeu_si256 ((__m256i *) (p), (v))
#define SET(v) _mm256_set1_epi16 ((gint16) (v))
#define PAIR(a, b) \
  _mm256_set1_epi16 ((gint16) (((guint8) (b)) << 8 | (guint8) (a)))
#define ADD _mm256_add_epi16
#define SUB _mm256_sub_epi16
#define AVERAGE _mm256_avg_epu16
#define MUL_BYTES _mm256_maddubs_epi16
#define MUL_HIGH _mm256_mulhi_epi16
#define MUL_HIGH_U _mm256_mulhi_epu16
#define TIMES_4(v) _mm256_slli_epi16 ((v), 2)
#define BITS_BELOW(a, b, bound) \
  ((guint32) _mm256_movemask_epi8 (_mm256_blendv_epi8 ( \
          _mm256_cmpgt_epi16 ((bound), (a)), \
          _mm256_cmpgt_epi16 ((bound), (b)), \
          _mm256_set1_epi16 ((gint16) 0xff00))))
#include "gst/vision/corner/saddle-mask-tile.h"
#undef SUFFIX
#undef TARGET
#undef LANES
#undef VEC
#undef LOAD
#undef STORE
#undef SET
#undef PAIR
#undef ADD
#undef SUB
#undef AVERAGE
#undef MUL_BYTES
#undef MUL_HIGH
#undef MUL_HIGH_U
#undef TIMES_4
#undef BITS_BELOW

#define SUFFIX avx512
#define TARGET __attribute__((target ("bmi2,avx512f,avx512bw,avx512dq,avx512vl")))
#define LANES 32
#define VEC __m512i
#define LOAD(p) _mm512_loadu_si512 ((const void *) (p))
#define STORE(p, v) _mm512_storeu_si512 ((void *) (p), (v))
#define SET(v) _mm512_set1_epi16 ((gint16) (v))
#define PAIR(a, b) \
  _mm512_set1_epi16 ((gint16) (((guint8) (b)) << 8 | (guint8) (a)))
#define ADD _mm512_add_epi16
#define SUB _mm512_sub_epi16
#define AVERAGE _mm512_avg_epu16
#define MUL_BYTES _mm512_maddubs_epi16
#define MUL_HIGH _mm512_mulhi_epi16
#define MUL_HIGH_U _mm512_mulhi_epu16
#define TIMES_4(v) _mm512_slli_epi16 ((v), 2)
/* Spread by the scalar unit, which has nothing else to do. */
#define BITS_BELOW(a, b, bound) \
  (_pdep_u64 (_mm512_cmpgt_epi16_mask ((bound), (a)), 0x5555555555555555) | \
      _pdep_u64 (_mm512_cmpgt_epi16_mask ((bound), (b)), 0xaaaaaaaaaaaaaaaa))
#include "gst/vision/corner/saddle-mask-tile.h"

#endif
