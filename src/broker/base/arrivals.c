/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

void arrivals_add(struct arrivals *a, struct mail *m, uint64_t mail_ns)
{
    m->came_ns = mail_ns;
    m->older = a->newest;
    m->newer = NULL;
    if (a->newest) {
        a->newest->newer = m;
    } else {
        a->oldest = m;
    }
    a->newest = m;
}

void arrivals_remove(struct arrivals *a, struct mail *m)
{
    if (m->older) {
        m->older->newer = m->newer;
    } else {
        a->oldest = m->newer;
    }
    if (m->newer) {
        m->newer->older = m->older;
    } else {
        a->newest = m->older;
    }
}

uint64_t arrivals_oldest_ns(const struct arrivals *a, uint64_t mail_ns)
{
    return a->oldest && mail_ns > a->oldest->came_ns ? mail_ns - a->oldest->came_ns : 0;
}
