/* SPDX-License-Identifier: Apache-2.0 */
#include "web/json.h"

static unsigned beam_cm(float range_m)
{
    float cm = range_m * 100.0f + 0.5f;
    return cm >= 0.0f && cm < (float)BEAMS_FAR_CM ? (unsigned)cm : BEAMS_FAR_CM;
}

size_t beams_write(char text[BEAMS_TEXT], const float *range_m, size_t count)
{
    size_t stride = (count + BEAMS_SHOWN_MAX - 1) / BEAMS_SHOWN_MAX;
    size_t shown = 0;
    for (size_t i = 0; i < count; i += stride, shown++) {
        unsigned cm = beam_cm(range_m[i]);
        text[2 * shown] = BEAMS_DIGITS[cm / 64];
        text[2 * shown + 1] = BEAMS_DIGITS[cm % 64];
    }
    text[2 * shown] = '\0';
    return shown;
}
