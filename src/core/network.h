/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file network.h
 * The options that say which network a program joins: the same for every program.
 */
#ifndef MUSTER_CORE_NETWORK_H
#define MUSTER_CORE_NETWORK_H

#include "core/options.h"

struct mu_network {
    int64_t domain;
    const char *interface; /* NULL: loopback */
    const char *peer;      /* NULL: broker and simulator are on this host */
};

/* Rows for a table of options; network is a struct mu_network that outlives the parsing. */
#define MU_NETWORK_OPTIONS(network)                                                             \
    {.name = "domain",                                                                          \
     .kind = MU_OPTION_INTEGER,                                                                 \
     .unit = "D",                                                                               \
     .environment = "MUSTER_DOMAIN",                                                            \
     .help = "DDS domain",                                                                      \
     .target = &(network).domain,                                                               \
     .min = 0,                                                                                  \
     .max = 230},                                                                               \
        {.name = "interface",                                                                   \
         .kind = MU_OPTION_STRING,                                                              \
         .unit = "ADDRESS",                                                                     \
         .environment = "MUSTER_INTERFACE",                                                     \
         .help = "network interface (default: loopback alone)",                                 \
         .target = &(network).interface},                                                       \
    {                                                                                           \
        .name = "peer", .kind = MU_OPTION_STRING, .unit = "HOST", .environment = "MUSTER_PEER", \
        .help = "host of broker and simulator, when it is another", .target = &(network).peer   \
    }

#endif
