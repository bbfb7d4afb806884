/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file config.h
 * The Cyclone DDS configuration of a process, as XML.
 */
#ifndef MUSTER_BUS_CONFIG_H
#define MUSTER_BUS_CONFIG_H

#include "bus/bus.h"
#include "core/text.h"

/** The indices that agents and observers share out among themselves. */
enum {
    CONFIG_INDEX_BROKER = 0,
    CONFIG_INDEX_SIMULATOR = 1,
    CONFIG_INDEX_FIRST = 10,
    CONFIG_INDEX_LAST = 119
};

/** Writes the configuration of one participant index. */
void config_write(struct mu_text *xml, const struct bus_options *options, int index);

#endif
