/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file scene_json.h
 * A Scene as the page reads it: metres and radians, points as lists of numbers.  Pure.
 */
#ifndef MUSTER_WEB_SCENE_JSON_H
#define MUSTER_WEB_SCENE_JSON_H

#include "core/text.h"
#include "wire.h"

/** Writes all of it into a text, which is cut when it has no room. */
void scene_json_write(struct mu_text *text, const muster_Scene *scene);

#endif
