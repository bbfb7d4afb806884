/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

#include "core/text.h"

#include <stdlib.h>

bool disk_default_path(char *path, size_t size, int domain, const char *broker)
{
    const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
    struct mu_text t = mu_text_in(path, size);
    if (state && state[0] == '/') {
        mu_text_add(&t, state);
    } else if (home && home[0] == '/') {
        mu_text_format(&t, "%s/.local/state", home);
    } else {
        return false;
    }
    mu_text_format(&t, "/muster/%d-%s.db", domain, broker);
    return !t.cut;
}
