/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file config.h
 * The Cyclone DDS configuration of a process, as XML.
 */
#ifndef MUSTER_BUS_CONFIG_H
#define MUSTER_BUS_CONFIG_H

#include "bus/bus.h"
#include "core/text.h"

enum {
    CONFIG_BROKERS_MAX = 4, /* on one host */
    CONFIG_INDEX_SIMULATOR = 1,
    CONFIG_INDEX_FIRST = 10, /* to LAST: agents and observers share them out among themselves */
    CONFIG_INDEX_LAST = 118,
    CONFIG_INDEX_END = 119, /* MaxAutoParticipantIndex: a process that peers with a whole host calls
                               on those below it, in spite of the name */
    CONFIG_XML_MAX = 32 * 1024,
};

/** The indices of brokers, in the order in which they are taken. */
extern const int config_broker_indices[CONFIG_BROKERS_MAX];

/** @return the index-th participant index that a place may have, or -1 past the last */
int config_index(enum bus_place place, int index);

/**
 * Takes the next host out of a list that is joined by commas.
 *
 * @param at  in, out: where to go on; NULL at the end
 * @return its first character; NULL: there is none any more, or it is no name or address of a host
 */
const char *config_host(const char **at, size_t *len);

/** @return whether a list of hosts can be peered with: 1 to MU_PEERS_MAX names or addresses */
bool config_hosts_valid(const char *hosts);

/** @return whether an interface, by its address, is loopback; NULL, the usual one, is */
bool config_is_loopback(const char *interface);

/** Writes the configuration of one participant index. */
void config_write(struct mu_text *xml, const struct bus_options *options, int index);

#endif
