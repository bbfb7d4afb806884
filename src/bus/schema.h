/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file schema.h
 * A type as text, for whoever reads recordings: made from what the type says of itself on DDS.
 *
 * The text is a ROS 2 message definition ("ros2msg"), with all types that it is made of, because
 * most tools know that one.  An enumeration becomes an integer, and its words constants.
 */
#ifndef MUSTER_BUS_SCHEMA_H
#define MUSTER_BUS_SCHEMA_H

#include "core/text.h"
#include "muster/result.h"

#include <dds/dds.h>

/**
 * Writes the definition of a type.
 *
 * @param name  out: "muster/msg/Frame"
 * @param text  out: the definition
 * @return MU_OK; MU_ABSENT: the type does not describe itself; MU_REFUSED: it has something that
 *         such a definition cannot say, such as a union; MU_FULL: no room
 */
mu_result schema_write(const dds_topic_descriptor_t *descriptor, struct mu_text *name,
                       struct mu_text *text);

#endif
