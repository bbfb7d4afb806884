/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file palette.h
 * Colours that tell robots apart: the same wherever a robot is drawn, on a light ground and on a
 * dark one.
 */
#ifndef MUSTER_CORE_PALETTE_H
#define MUSTER_CORE_PALETTE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PALETTE_HEX = sizeof "#rrggbb" };

struct palette_color {
    char light[PALETTE_HEX], dark[PALETTE_HEX]; /* for a ground that is so */
    unsigned pattern; /* of a line: 0 solid, 1 dashed, 2 dotted; beyond twenty robots colours alone
                         do not tell them apart */
};

/* A robot that needs a colour. */
struct palette_robot {
    const char *name; /* the colour that it is called after, if no other has that */
    uint32_t rgb; /* the world's or the experiment's; one that others have, too, does not count */
    bool stands;  /* no program drives it: its colour does not change those of driven robots */
};

/** Chooses a colour for each of the robots, in their order: its own, else that of its name, else
 * one of twenty, else one of ever so many. */
void palette_choose(struct palette_color *colors, const struct palette_robot *robots, size_t count);

#endif
