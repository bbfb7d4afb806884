/* SPDX-License-Identifier: Apache-2.0 */
#include "core/network.h"

#include "core/text.h"
#include "muster/memory.h"

#include <string.h>

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
    struct mu_text text;
    mu_text_init(&text, joined, bytes);
    for (size_t i = 0; i < network->peers.count; i++) {
        mu_text_format(&text, "%s%s", i ? "," : "", network->peers.items[i]);
    }
    return joined;
}
