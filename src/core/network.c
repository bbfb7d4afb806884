/* SPDX-License-Identifier: Apache-2.0 */
#include "core/network.h"

#include "core/text.h"
#include "muster/memory.h"

#include <stdio.h>
#include <string.h>

static const double wait_default_s = 2.5;

const char *mu_network_peers(const struct mu_network *network)
{
    size_t bytes = 0;
    for (size_t i = 0; i < network->peers.count; i++) {
        bytes += strlen(network->peers.items[i]) + 1;
    }
    if (bytes == 0) {
        return NULL;
    }
    char *joined = mu_startup_alloc(bytes);
    struct mu_text text = mu_text_in(joined, bytes);
    for (size_t i = 0; i < network->peers.count; i++) {
        mu_text_format(&text, "%s%s", i ? "," : "", network->peers.items[i]);
    }
    return joined;
}

static double wait_s(const struct mu_network *network)
{
    return network->wait_broker_s > 0 ? network->wait_broker_s : wait_default_s;
}

uint64_t mu_network_wait_ns(const struct mu_network *network)
{
    return (uint64_t)(wait_s(network) * 1e9);
}

void mu_network_waits(const struct mu_network *network, const char *program, int domain)
{
    fprintf(stderr, "%s: waits for a broker%s%s in domain %d\n", program,
            network->broker ? " named " : "", network->broker ? network->broker : "", domain);
}

void mu_network_missed(const struct mu_network *network, const char *program, int domain)
{
    fprintf(stderr,
            "%s: no broker%s%s answers in domain %d within %g s (--%s S waits longer); start one "
            "with: muster broker %s --domain %d\n",
            program, network->broker ? " named " : "", network->broker ? network->broker : "",
            domain, wait_s(network), network->wait_option ? network->wait_option : "wait-broker",
            network->broker ? network->broker : "NAME", domain);
}
