/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file profile.h
 * Quality of service as rosbag2 writes it into its files ("offered_qos_profiles"): YAML, with the
 * numbers of the rmw.
 */
#ifndef MUSTER_BUS_PROFILE_H
#define MUSTER_BUS_PROFILE_H

#include "core/text.h"

#include <dds/dds.h>

/** Writes the profile; what is not set is DDS's default. */
void profile_write(const dds_qos_t *qos, struct mu_text *text);

#endif
