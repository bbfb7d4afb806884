/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file assets.h
 * The files of the page, which are part of the program: assets/, as they stand there.
 */
#ifndef MUSTER_WEB_ASSETS_H
#define MUSTER_WEB_ASSETS_H

#include <stddef.h>

struct asset {
    const char *path; /* "/page.css" */
    const char *type; /* of its content, as HTTP names it */
    const char *bytes, *end;
};

/** @return the asset of a path, exactly; "/" is the page itself; NULL: there is none */
const struct asset *assets_find(const char *path);

/** @return the index-th asset; NULL past the last */
const struct asset *assets_at(size_t index);

#endif
