/* SPDX-License-Identifier: Apache-2.0 */
#include "core/log.h"
#include "core/text.h"
#include "resolver/scheme.h"

bool offers_resolve(mu_process *p, const char *key, const char *value, mu_resolution *r)
{
    char query[MU_QUERY_MAX + 1];
    const struct mu_service *s;
    struct mu_text t = mu_text_in(query, sizeof query);
    mu_text_format(&t, "* %s=%s", key, value);
    if (t.cut) {
        return false;
    }
    for (size_t i = 0; (s = mu_process_find_service(p, query, i)); i++) {
        if (mu_resolution_add(r, s->agent) == MU_FULL) {
            mu_log(MU_LOG_WARNING, "too-many", "%s=%s", key, value);
            break;
        }
    }
    return true;
}
