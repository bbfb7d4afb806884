/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/traffic.h"

#include "bus/bus.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

static int shared = -1; /* the table's descriptor */
static char preload[8192];

mu_result traffic_make(struct traffic **out, uint64_t seed, const char *library)
{
    int fd = memfd_create("muster-traffic", 0); /* children inherit it */
    bool sized = fd >= 0 && ftruncate(fd, sizeof **out) == 0;
    void *table =
        sized ? mmap(NULL, sizeof **out, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0) : MAP_FAILED;
    if (table == MAP_FAILED) {
        perror("muster: cannot make the table of traffic");
        return MU_FAULT_OS;
    }
    *out = table;
    (*out)->seed = seed;
    shared = fd;
    const char *others = getenv("LD_PRELOAD");
    snprintf(preload, sizeof preload, "LD_PRELOAD=%s%s%s", others ? others : "", others ? " " : "",
             library);
    setenv(LOCAL_ENVIRONMENT, "off", 1); /* all is packets */
    traffic_child(0);
    return MU_OK;
}

void traffic_child(unsigned part)
{
    static char variable[64];
    snprintf(variable, sizeof variable, TRAFFIC_ENVIRONMENT "=%d:%u", shared, part);
    putenv(variable); /* which keeps the buffer */
    putenv(preload);
}

void traffic_set(struct traffic *t, unsigned one, unsigned other, double share, double by_ms)
{
    struct traffic_rule *rules[] = {&t->rules[one][other], &t->rules[other][one]};
    for (size_t i = 0; i < 2; i++) {
        atomic_store(&rules[i]->lost_ppm, (uint32_t)(share * 1e6));
        atomic_store(&rules[i]->late_us, (uint32_t)(by_ms * 1e3));
    }
}

uint64_t traffic_struck(const struct traffic *t)
{
    return atomic_load(&t->struck);
}
