/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file network.h
 * The options that say which network a program joins: the same for every program.
 */
#ifndef MUSTER_CORE_NETWORK_H
#define MUSTER_CORE_NETWORK_H

#include "core/options.h"
#include "muster/limits.h"

struct mu_network {
    int64_t domain;
    const char *interface;       /* NULL: loopback */
    const char *local;           /* "off": DDS alone between processes of this host, too; or NULL */
    struct mu_option_list peers; /* none: brokers and simulator are on this host */
    const char *broker;          /* the one to begin with; NULL: the nearest */
    double wait_broker_s;        /* for one that answers; 0: the default */
    const char *wait_option;     /* that says so; NULL: wait-broker */
};

/* Rows for a table of options; network is a struct mu_network that outlives the parsing. */
#define MU_NETWORK_OPTIONS(network)                                                           \
    MU_INTEGER("domain", "D", (network).domain, "DDS domain", .environment = "MUSTER_DOMAIN", \
               .max = MU_DOMAIN_MAX),                                                         \
        MU_STRING("interface", "ADDRESS", (network).interface,                                \
                  "network interface (default: loopback alone)",                              \
                  .environment = "MUSTER_INTERFACE"),                                         \
        MU_STRING("local", "on|off", (network).local,                                         \
                  "sockets beside DDS between processes of one host (default: on)",           \
                  .environment = "MUSTER_LOCAL"),                                             \
        MU_NAMES("peer", "HOST", (network).peers,                                             \
                 "host of brokers and simulator, when another; or several, with commas",      \
                 .environment = "MUSTER_PEER")

/* The same for programs whose agents live with a broker. */
#define MU_JOIN_OPTIONS(network)                                                                 \
    MU_NETWORK_OPTIONS(network),                                                                 \
        MU_STRING("broker", "NAME", (network).broker,                                            \
                  "broker to begin with (default: the first one of this host, else of another)", \
                  .environment = "MUSTER_BROKER"),                                               \
        MU_REAL("wait-broker", "S", (network).wait_broker_s,                                     \
                "wait so long for a broker (default: 2.5)", .environment = MU_NETWORK_WAIT,      \
                .max = 1e9)

/* A run's children are told by it to wait for ever: they end with the run. */
#define MU_NETWORK_WAIT "MUSTER_WAIT_BROKER"

/** @return how long a program waits for a broker before it says that none answers, nanoseconds */
uint64_t mu_network_wait_ns(const struct mu_network *network);

/** Says that a program waits for a broker in its domain. */
void mu_network_waits(const struct mu_network *network, const char *program, int domain);

/** Says that none answered, and what to do about it. */
void mu_network_missed(const struct mu_network *network, const char *program, int domain);

/** @return the peers joined by commas, in start-up memory; NULL: none */
const char *mu_network_peers(const struct mu_network *network);

#endif
