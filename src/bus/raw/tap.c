/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/raw/raw.h"

#include "bus/topics.h"
#include "core/clock.h"
#include "core/log.h"

#include <string.h>

enum { ENDPOINTS_MAX = 4096 };

static const dds_duration_t TYPE_NS = 200000000;
static const uint64_t RETRY_NS = 1000000000;

/* --- one tap ---------------------------------------------------------------------------------- */

static dds_qos_t *qos_of(const struct tap *t)
{
    dds_qos_t *qos = dds_create_qos();
    MU_ASSERT(qos);
    dds_qset_reliability(qos, t->reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                         0);
    dds_qset_durability(qos, t->durable ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, TAP_DEPTH);
    dds_qset_ownership(qos, t->exclusive ? DDS_OWNERSHIP_EXCLUSIVE : DDS_OWNERSHIP_SHARED);
    return qos;
}

/* Of Frames every one, and none twice: docs/observing.md. */
static dds_entity_t subscriber_open(struct bus *bus, const struct tap *t)
{
    const char *all[] = {"", "*"};
    const char *every[] = {"every"};
    bool once = t->ours && strcmp(t->name, "Frame") == 0;
    dds_qos_t *group = dds_create_qos();
    dds_qset_partition(group, once ? 1 : 2, once ? every : all);
    dds_entity_t subscriber = dds_create_subscriber(bus->participant, group, NULL);
    dds_delete_qos(group);
    return subscriber;
}

/* Opens the reader of a tap whose topic is there, or another one in its place. */
static void reader_open(struct bus *bus, struct tap *t)
{
    dds_entity_t subscriber = subscriber_open(bus, t);
    dds_qos_t *qos = qos_of(t);
    if (t->reader > 0) {
        dds_delete(dds_get_subscriber(t->reader));
    }
    t->reader = subscriber < 0 ? 0 : dds_create_reader(subscriber, t->topic, qos, NULL);
    t->reader = t->reader < 0 ? 0 : t->reader;
    dds_delete_qos(qos);
}

mu_result tap_open(struct tap *tap, struct bus *bus, enum bus_topic topic)
{
    const struct topic *t = &topic_table[topic];
    *tap = (struct tap){.reliable = true, .durable = t->for_late_comers, .ours = true};
    (void)mu_text_copy(tap->name, sizeof tap->name, t->name);
    (void)mu_text_copy(tap->type, sizeof tap->type, t->descriptor->m_typename);
    tap->topic = dds_create_topic(bus->participant, t->descriptor, t->name, NULL, NULL);
    if (tap->topic > 0) {
        reader_open(bus, tap);
    }
    return tap->reader > 0 ? MU_OK : MU_FAULT_DDS;
}

/* Has the type from a process that describes it.  @return the topic, or below 0 */
static dds_entity_t foreign_topic(struct bus *bus, const struct tap *t,
                                  dds_builtintopic_endpoint_t *endpoint)
{
    const dds_typeinfo_t *info = NULL;
    dds_topic_descriptor_t *descriptor = NULL;
    dds_return_t got = dds_builtintopic_get_endpoint_type_info(endpoint, &info);
    got = got == DDS_RETCODE_OK && !info ? DDS_RETCODE_NOT_FOUND : got;
    got = got == DDS_RETCODE_OK
              ? dds_create_topic_descriptor(DDS_FIND_SCOPE_GLOBAL, bus->participant, info, TYPE_NS,
                                            &descriptor)
              : got;
    if (got != DDS_RETCODE_OK) {
        return got;
    }
    dds_entity_t topic = type_topic(bus->participant, descriptor, t->name);
    dds_delete_topic_descriptor(descriptor);
    return topic;
}

static void tap_try(struct bus *bus, struct tap *t, dds_builtintopic_endpoint_t *endpoint)
{
    const struct topic *ours = topics_find(t->name, t->type);
    uint64_t now_ns = mu_clock_ns();
    if (now_ns < t->retry_ns) {
        return;
    }
    t->ours = ours != NULL;
    dds_entity_t topic =
        ours ? dds_create_topic(bus->participant, ours->descriptor, t->name, NULL, NULL)
             : foreign_topic(bus, t, endpoint);
    if (topic > 0) {
        t->topic = topic;
        reader_open(bus, t);
        return;
    }
    if (t->retry_ns == 0) {
        mu_log(MU_LOG_WARNING, "no-type", "topic=%s type=%s: %s", t->name, t->type,
               dds_strretcode(topic));
    }
    t->retry_ns = mu_clock_ns() + RETRY_NS;
}

/* --- what there is ---------------------------------------------------------------------------- */

mu_result tap_watch_open(struct tap_watch *watch, struct bus *bus)
{
    *watch = (struct tap_watch){.bus = bus};
    watch->publications =
        dds_create_reader(bus->participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, NULL, NULL);
    watch->subscriptions =
        dds_create_reader(bus->participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, NULL, NULL);
    return watch->publications < 0 || watch->subscriptions < 0 ? MU_FAULT_DDS : MU_OK;
}

static bool offers_reliable(const dds_builtintopic_endpoint_t *e)
{
    dds_reliability_kind_t kind = DDS_RELIABILITY_RELIABLE;
    (void)dds_qget_reliability(e->qos, &kind, NULL);
    return kind == DDS_RELIABILITY_RELIABLE;
}

static bool offers_durable(const dds_builtintopic_endpoint_t *e)
{
    dds_durability_kind_t kind = DDS_DURABILITY_VOLATILE;
    (void)dds_qget_durability(e->qos, &kind);
    return kind >= DDS_DURABILITY_TRANSIENT_LOCAL;
}

/* No writer gives a reader both kinds of instances: each has a tap of its own. */
static bool offers_exclusive(const dds_builtintopic_endpoint_t *e)
{
    dds_ownership_kind_t kind = DDS_OWNERSHIP_SHARED;
    (void)dds_qget_ownership(e->qos, &kind);
    return kind == DDS_OWNERSHIP_EXCLUSIVE;
}

static struct tap *tap_find(struct tap *taps, size_t count, const dds_builtintopic_endpoint_t *e)
{
    for (size_t i = 0; i < count; i++) {
        if (strcmp(taps[i].name, e->topic_name) == 0 && strcmp(taps[i].type, e->type_name) == 0 &&
            taps[i].exclusive == offers_exclusive(e)) {
            return &taps[i];
        }
    }
    return NULL;
}

/* Asks for no more than a writer offers: else there is nothing from it. */
static void tap_lower(struct bus *bus, struct tap *t, const dds_builtintopic_endpoint_t *e)
{
    bool reliable = t->reliable && offers_reliable(e);
    bool durable = t->durable && offers_durable(e);
    if (reliable != t->reliable || durable != t->durable) {
        t->reliable = reliable;
        t->durable = durable;
        if (t->topic > 0) {
            reader_open(bus, t);
        }
    }
}

static bool is_own(const struct bus *bus, const dds_builtintopic_endpoint_t *e)
{
    dds_guid_t own;
    return dds_get_guid(bus->participant, &own) == DDS_RETCODE_OK &&
           memcmp(&own, &e->participant_key, sizeof own) == 0;
}

static bool is_tapped(const struct tap_watch *w, const dds_builtintopic_endpoint_t *e,
                      bool (*wanted)(const char *))
{
    bool fits = strlen(e->topic_name) <= TAP_NAME_MAX && strlen(e->type_name) <= TAP_NAME_MAX;
    return fits && !is_own(w->bus, e) && (!wanted || wanted(e->topic_name));
}

/* A writer: its topic gets a tap. */
static void publication_take(struct tap_watch *w, struct tap *taps, size_t *count, size_t max,
                             dds_builtintopic_endpoint_t *e)
{
    struct tap *t = tap_find(taps, *count, e);
    if (!t && *count < max) {
        t = &taps[(*count)++];
        *t = (struct tap){.reliable = offers_reliable(e),
                          .durable = offers_durable(e),
                          .exclusive = offers_exclusive(e)};
        mu_text_copy(t->name, sizeof t->name, e->topic_name);
        mu_text_copy(t->type, sizeof t->type, e->type_name);
    }
    if (t) {
        tap_lower(w->bus, t, e);
    }
    if (t && t->topic == 0) {
        tap_try(w->bus, t, e);
    }
}

/* Goes through the writers, or the readers, that are there now: all, or the new ones. */
static size_t endpoints_look(struct tap_watch *w, bool writers, struct tap *taps, size_t count,
                             size_t max, bool (*wanted)(const char *))
{
    dds_entity_t endpoints = writers ? w->publications : w->subscriptions;
    uint32_t mask = w->looked_ns == 0
                        ? DDS_ANY_STATE
                        : DDS_NOT_READ_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ANY_INSTANCE_STATE;
    static void *found[ENDPOINTS_MAX];
    static dds_sample_info_t infos[ENDPOINTS_MAX];
    found[0] = NULL;
    dds_return_t got = dds_read_mask(endpoints, found, infos, ENDPOINTS_MAX, ENDPOINTS_MAX, mask);
    for (dds_return_t i = 0; i < got; i++) {
        dds_builtintopic_endpoint_t *e = found[i];
        bool there = infos[i].valid_data && infos[i].instance_state == DDS_IST_ALIVE;
        if (!there || !is_tapped(w, e, wanted)) {
            continue;
        }
        if (writers) {
            publication_take(w, taps, &count, max, e);
        } else { /* a reader may describe what its writers do not */
            struct tap *t = tap_find(taps, count, e);
            if (t && t->topic == 0) {
                t->retry_ns = 0;
                tap_try(w->bus, t, e);
            }
        }
    }
    if (got > 0) {
        (void)dds_return_loan(endpoints, found, got);
    }
    return count;
}

size_t tap_watch_look(struct tap_watch *watch, struct tap *taps, size_t count, size_t max,
                      bool (*wanted)(const char *topic))
{
    uint64_t now_ns = mu_clock_ns();
    bool all_open = true;
    if (now_ns - watch->looked_ns >= RETRY_NS) {
        watch->looked_ns = 0;
    }
    count = endpoints_look(watch, true, taps, count, max, wanted);
    for (size_t i = 0; i < count; i++) {
        all_open = all_open && taps[i].topic > 0;
    }
    if (!all_open) {
        count = endpoints_look(watch, false, taps, count, max, wanted);
    }
    watch->looked_ns = watch->looked_ns ? watch->looked_ns : now_ns;
    return count;
}
