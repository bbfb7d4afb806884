/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/join.h"

#include "bus/bus.h"

#include <stdlib.h>

enum { JOIN_SILENT_NS = 1000000000 };

struct mu_process_options join_options(const struct mu_network *network, const char *name)
{
    if (network->local) {
        setenv(LOCAL_ENVIRONMENT, network->local,
               1); /* the library's options have no word for it */
    }
    return (struct mu_process_options){.domain =
                                           network->domain ? (int)network->domain : MU_DOMAIN_ZERO,
                                       .interface = network->interface,
                                       .peer = mu_network_peers(network),
                                       .name = name,
                                       .broker = network->broker};
}

mu_result join_await(mu_process *p, const struct mu_network *network, const char *program,
                     int domain)
{
    uint64_t wait_ns = mu_network_wait_ns(network);
    uint64_t silent_ns = wait_ns < JOIN_SILENT_NS ? wait_ns : JOIN_SILENT_NS;
    mu_result found = mu_process_await_broker(p, silent_ns);
    if (found == MU_TIMEOUT && wait_ns > silent_ns) {
        mu_network_waits(network, program, domain);
        found = mu_process_await_broker(p, wait_ns - silent_ns);
    }
    if (found == MU_TIMEOUT) {
        mu_network_missed(network, program, domain);
    }
    return found;
}
