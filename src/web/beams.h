/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file beams.h
 * Readings of a sonar or laser for the page: two characters each, whole centimetres.
 *
 * A reading is 64 times the place of its first character in BEAMS_DIGITS and the place of its
 * second.  Twenty times a second a hundred robots have thousands of them; as decimal numbers
 * they would be most of what is sent.
 */
#ifndef MUSTER_WEB_BEAMS_H
#define MUSTER_WEB_BEAMS_H

#include <stddef.h>
#include <stdint.h>

#define BEAMS_DIGITS "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"

enum {
    BEAMS_SHOWN_MAX = 181, /* of one sensor; of more, each second, third, ... is shown */
    BEAMS_FAR_CM = 4095,   /* and further, and what is no number */
    BEAMS_TEXT = 2 * BEAMS_SHOWN_MAX + 1
};

/** Writes count readings, or as many of them, evenly, as are shown.  @return how many */
size_t beams_write(char text[BEAMS_TEXT], const float *range_m, size_t count);

#endif
