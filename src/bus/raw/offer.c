/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/raw/raw.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBERS_MAX = 3 };

/* A policy: its name, and how many numbers it has. */
struct policy {
    const char *name;
    int count;
    bool (*get)(const dds_qos_t *qos, int64_t n[NUMBERS_MAX]);
    void (*set)(dds_qos_t *qos, const int64_t n[NUMBERS_MAX]);
};

/* --- each policy ------------------------------------------------------------------------------ */

static bool reliability_get(const dds_qos_t *qos, int64_t n[])
{
    dds_reliability_kind_t kind;
    bool there = dds_qget_reliability(qos, &kind, NULL);
    n[0] = there ? (int64_t)kind : 0;
    return there;
}

static void reliability_set(dds_qos_t *qos, const int64_t n[])
{
    dds_qset_reliability(qos, (dds_reliability_kind_t)n[0], 0);
}

static bool durability_get(const dds_qos_t *qos, int64_t n[])
{
    dds_durability_kind_t kind;
    bool there = dds_qget_durability(qos, &kind);
    n[0] = there ? (int64_t)kind : 0;
    return there;
}

static void durability_set(dds_qos_t *qos, const int64_t n[])
{
    dds_qset_durability(qos, (dds_durability_kind_t)n[0]);
}

static bool deadline_get(const dds_qos_t *qos, int64_t n[])
{
    return dds_qget_deadline(qos, &n[0]);
}

static void deadline_set(dds_qos_t *qos, const int64_t n[])
{
    dds_qset_deadline(qos, n[0]);
}

static bool latency_get(const dds_qos_t *qos, int64_t n[])
{
    return dds_qget_latency_budget(qos, &n[0]);
}

static void latency_set(dds_qos_t *qos, const int64_t n[])
{
    dds_qset_latency_budget(qos, n[0]);
}

static bool lifespan_get(const dds_qos_t *qos, int64_t n[])
{
    return dds_qget_lifespan(qos, &n[0]);
}

static void lifespan_set(dds_qos_t *qos, const int64_t n[])
{
    dds_qset_lifespan(qos, n[0]);
}

static bool liveliness_get(const dds_qos_t *qos, int64_t n[])
{
    dds_liveliness_kind_t kind;
    bool there = dds_qget_liveliness(qos, &kind, &n[1]);
    n[0] = there ? (int64_t)kind : 0;
    return there;
}

static void liveliness_set(dds_qos_t *qos, const int64_t n[])
{
    dds_qset_liveliness(qos, (dds_liveliness_kind_t)n[0], n[1]);
}

static bool ownership_get(const dds_qos_t *qos, int64_t n[])
{
    dds_ownership_kind_t kind;
    int32_t strength = 0;
    bool there = dds_qget_ownership(qos, &kind);
    (void)dds_qget_ownership_strength(qos, &strength);
    n[0] = there ? (int64_t)kind : 0;
    n[1] = strength;
    return there;
}

static void ownership_set(dds_qos_t *qos, const int64_t n[])
{
    dds_qset_ownership(qos, (dds_ownership_kind_t)n[0]);
    dds_qset_ownership_strength(qos, (int32_t)n[1]);
}

static bool order_get(const dds_qos_t *qos, int64_t n[])
{
    dds_destination_order_kind_t kind;
    bool there = dds_qget_destination_order(qos, &kind);
    n[0] = there ? (int64_t)kind : 0;
    return there;
}

static void order_set(dds_qos_t *qos, const int64_t n[])
{
    dds_qset_destination_order(qos, (dds_destination_order_kind_t)n[0]);
}

static bool presentation_get(const dds_qos_t *qos, int64_t n[])
{
    dds_presentation_access_scope_kind_t scope;
    bool coherent, ordered;
    if (!dds_qget_presentation(qos, &scope, &coherent, &ordered)) {
        return false;
    }
    n[0] = (int64_t)scope;
    n[1] = coherent;
    n[2] = ordered;
    return true;
}

static void presentation_set(dds_qos_t *qos, const int64_t n[])
{
    dds_qset_presentation(qos, (dds_presentation_access_scope_kind_t)n[0], n[1] != 0, n[2] != 0);
}

/* The first one: the others are for readers to choose from. */
static bool representation_get(const dds_qos_t *qos, int64_t n[])
{
    uint32_t count = 0;
    dds_data_representation_id_t *ids = NULL;
    bool there = dds_qget_data_representation(qos, &count, &ids) && count > 0;
    n[0] = there ? ids[0] : 0;
    dds_free(ids);
    return there;
}

static void representation_set(dds_qos_t *qos, const int64_t n[])
{
    const dds_data_representation_id_t id = (dds_data_representation_id_t)n[0];
    dds_qset_data_representation(qos, 1, &id);
}

static bool history_get(const dds_qos_t *qos, int64_t n[])
{
    dds_history_kind_t kind;
    int32_t depth;
    bool there = dds_qget_history(qos, &kind, &depth);
    n[0] = there ? (int64_t)kind : 0;
    n[1] = there ? depth : 0;
    return there;
}

static void history_set(dds_qos_t *qos, const int64_t n[])
{
    dds_qset_history(qos, (dds_history_kind_t)n[0], (int32_t)n[1]);
}

static const struct policy policies[] = {
    {"reliability", 1, reliability_get, reliability_set},
    {"durability", 1, durability_get, durability_set},
    {"history", 2, history_get, history_set},
    {"deadline", 1, deadline_get, deadline_set},
    {"latency", 1, latency_get, latency_set},
    {"lifespan", 1, lifespan_get, lifespan_set},
    {"liveliness", 2, liveliness_get, liveliness_set},
    {"ownership", 2, ownership_get, ownership_set},
    {"order", 1, order_get, order_set},
    {"presentation", 3, presentation_get, presentation_set},
    {"representation", 1, representation_get, representation_set},
};

/* --- words ------------------------------------------------------------------------------------ */

void offer_write(const dds_qos_t *qos, struct mu_text *words)
{
    for (size_t i = 0; i < sizeof policies / sizeof policies[0]; i++) {
        const struct policy *p = &policies[i];
        int64_t n[NUMBERS_MAX] = {0};
        if (!p->get(qos, n)) {
            continue;
        }
        mu_text_format(words, "%s%s=%" PRId64, words->len > 0 ? " " : "", p->name, n[0]);
        for (int k = 1; k < p->count; k++) {
            mu_text_format(words, ",%" PRId64, n[k]);
        }
    }
}

/* Reads "NAME=1,2".  @return whether it is that policy, with all of its numbers */
static bool word_read(const char *word, size_t len, const struct policy *p, int64_t n[])
{
    size_t name = strlen(p->name);
    if (len <= name || strncmp(word, p->name, name) != 0 || word[name] != '=') {
        return false;
    }
    const char *at = word + name;
    for (int k = 0; k < p->count; k++) {
        char *end;
        if (*at != (k == 0 ? '=' : ',')) {
            return false;
        }
        n[k] = strtoll(at + 1, &end, 10);
        if (end == at + 1 || end > word + len) {
            return false;
        }
        at = end;
    }
    return at == word + len;
}

void offer_read(const char *words, dds_qos_t *qos)
{
    while (*words) {
        size_t len = strcspn(words, " ");
        for (size_t i = 0; i < sizeof policies / sizeof policies[0]; i++) {
            int64_t n[NUMBERS_MAX] = {0};
            if (word_read(words, len, &policies[i], n)) {
                policies[i].set(qos, n);
            }
        }
        words += len;
        words += strspn(words, " ");
    }
}
