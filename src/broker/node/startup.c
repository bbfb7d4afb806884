/* SPDX-License-Identifier: Apache-2.0 */

#include "broker/node/disk_parts.h"
#include "core/clock.h"
#include "core/exits.h"
#include "core/log.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static mu_result store_open(struct startup *o, const struct settings *s)
{
    char path[PATH_MAX];
    if (s->store && strcmp(s->store, "none") == 0) {
        return MU_OK;
    }
    if (s->store ? !mu_text_copy(path, sizeof path, s->store)
                 : !disk_default_path(path, sizeof path, (int)s->network.domain, s->name)) {
        fprintf(stderr, "muster broker: no place for the store: give --store FILE or none\n");
        return MU_FAULT_OS;
    }
    return disk_open(&o->disk, path, mu_clock_wall_ns());
}

static mu_result store_load(struct startup *o)
{
    uint64_t refused = 0;
    mu_result loaded = o->disk ? disk_load(o->disk, o->broker, &refused) : MU_OK;
    if (refused > 0) {
        mu_log(MU_LOG_WARNING, "store-rows-not-taken", "rows=%llu", (unsigned long long)refused);
    }
    return loaded;
}

int startup_run(struct startup *o, const struct settings *s)
{
    mu_result opened = store_open(o, s);
    if (opened != MU_OK) {
        return mu_exit_for(opened);
    }
    uint64_t incarnation = o->disk ? o->disk->incarnation : mu_clock_wall_ns();
    uint64_t interval_ns = (uint64_t)(s->delivery_interval_ms * 1e6);
    struct box_limits boxes = {s->box_policy, (uint32_t)s->box_mails, (uint32_t)s->box_bytes};
    struct broker_options options = {.name = s->name,
                                     .incarnation = incarnation,
                                     .has_store = o->disk != NULL,
                                     .number_base = o->disk ? o->disk->number_base : 0,
                                     .pid = (uint32_t)getpid(),
                                     .wall_ns = mu_clock_wall_ns(),
                                     .delivery_interval_ns = interval_ns,
                                     .receipt_pause_ns = LIMITER_GOOD_PAUSE_NS,
                                     .names = (uint32_t)s->names,
                                     .name_expiry_ns = (uint64_t)s->name_expiry_s * 1000000000,
                                     .audit = s->audit != NULL,
                                     .boxes = boxes};
    o->broker = broker_open(&options);
    mu_result loaded = store_load(o);
    if (loaded != MU_OK) {
        return mu_exit_for(loaded);
    }
    if (s->policy && files_policy_load(o->broker, s->policy) != MU_OK) {
        return MU_EXIT_FILE;
    }
    return files_audit_open(&o->audit, s->audit) ? MU_EXIT_DONE : MU_EXIT_WRITE;
}
