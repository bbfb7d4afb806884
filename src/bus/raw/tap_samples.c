/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Samples of a tap, and what becomes of instances.
 *
 * DDS says that an instance has gone with a sample that has a key and no data only where no sample
 * with data lies unread; else the state stands beside that sample, and if the instance lives again
 * by then, nothing but a count says that it had gone.  So we remember the count of each instance.
 */
#include "bus/raw/raw.h"
#include "core/sort.h"

#include <dds/dds.h>

/* DDS's own headers want a word that C11 does not have. */
#define asm __asm__
#include <dds/ddsi/ddsi_serdata.h>

enum { ROUNDS_MAX = 16, LIVES = 1 << 16, ITEMS_MAX = 3 * TAP_BATCH + 1 };

/* What is known of an instance; of two that meet in one place the later one. */
struct life {
    uint64_t instance;
    int32_t reader;               /* 0: free */
    uint32_t disposed, abandoned; /* how often it has come back after either */
    enum gone_what gone;          /* as it was handed out last */
    dds_time_t time;              /* of what was handed out last */
};

/* What is handed out. */
struct item {
    uint32_t sample, number; /* number: as they were found */
    enum gone_what gone;
    dds_time_t time;
};

struct batch {
    struct ddsi_serdata *data[TAP_BATCH + 1];
    dds_sample_info_t infos[TAP_BATCH + 1];
    uint32_t count;
    struct item items[ITEMS_MAX];
    uint32_t item_count;
};

/* That its instance had gone stood beside the last sample of a full batch: more of it may follow,
 * and then say so again. */
struct held {
    struct ddsi_serdata *data; /* NULL: none */
    dds_sample_info_t info;
    int32_t reader;
};

static struct life lives[LIVES];
static struct held held;

static struct life *life_of(const struct tap *t, const dds_sample_info_t *info)
{
    uint64_t mixed = (info->instance_handle ^ (uint64_t)t->reader) * 0x9e3779b97f4a7c15u;
    struct life *l = &lives[mixed >> 48];
    if (l->reader != t->reader || l->instance != info->instance_handle) {
        *l = (struct life){.instance = info->instance_handle,
                           .reader = t->reader,
                           .disposed = info->disposed_generation_count,
                           .abandoned = info->no_writers_generation_count};
    }
    return l;
}

static enum gone_what gone_of(const dds_sample_info_t *info)
{
    return info->instance_state == DDS_IST_NOT_ALIVE_DISPOSED     ? GONE_DISPOSED
           : info->instance_state == DDS_IST_NOT_ALIVE_NO_WRITERS ? GONE_UNREGISTERED
                                                                  : GONE_NOT;
}

/* What becomes of one instance is told in its order. */
static void item_add(struct batch *b, struct life *l, uint32_t sample, enum gone_what gone,
                     dds_time_t time)
{
    bool returns = gone == GONE_NOT && l->gone != GONE_NOT;
    time = returns && time <= l->time ? l->time + 1 : time;
    time = gone != GONE_NOT && time < l->time ? l->time : time;
    l->time = time;
    l->gone = gone;
    b->items[b->item_count] = (struct item){sample, b->item_count, gone, time};
    b->item_count++;
}

/* An instance that came back without a word that it had gone. */
static void return_look(struct batch *b, struct life *l, uint32_t sample)
{
    const dds_sample_info_t *info = &b->infos[sample];
    bool disposed = info->disposed_generation_count > l->disposed;
    bool abandoned = info->no_writers_generation_count > l->abandoned;
    if (l->gone == GONE_NOT && (disposed || abandoned)) {
        item_add(b, l, sample, disposed ? GONE_DISPOSED : GONE_UNREGISTERED,
                 info->source_timestamp);
    }
}

/* When a writer is lost DDS gives the time of what it wrote last. */
static dds_time_t gone_time(const struct life *l, const dds_sample_info_t *info)
{
    bool lost = !info->valid_data && info->source_timestamp <= l->time;
    return lost ? dds_time() : info->source_timestamp;
}

/* @return whether it was put aside until the next batch */
static bool sample_hold(const struct batch *b, const struct tap *t, uint32_t i)
{
    bool holds = i + 1 == TAP_BATCH && b->infos[i].valid_data && !held.data;
    if (holds) {
        held = (struct held){ddsi_serdata_ref(b->data[i]), b->infos[i], t->reader};
    }
    return holds;
}

static void sample_look(struct batch *b, struct tap *t, uint32_t i)
{
    const dds_sample_info_t *info = &b->infos[i];
    struct life *l = life_of(t, info);
    if (info->valid_data) {
        return_look(b, l, i);
        item_add(b, l, i, GONE_NOT, info->source_timestamp);
    }
    l->disposed = info->disposed_generation_count;
    l->abandoned = info->no_writers_generation_count;
    bool last = i + 1 == b->count || b->infos[i + 1].instance_handle != info->instance_handle;
    enum gone_what gone = gone_of(info);
    if (last && gone != GONE_NOT && gone != l->gone && !sample_hold(b, t, i)) {
        item_add(b, l, i, gone, gone_time(l, info));
    } else if (!info->valid_data) {
        l->gone = gone;
    }
}

/* What was put aside before this batch, if nothing more of its instance is in it. */
static void held_look(struct batch *b, struct tap *t, const struct held *before)
{
    bool more = false;
    if (!before->data) {
        return;
    }
    for (uint32_t i = 0; i < b->count && !more; i++) {
        more = b->infos[i].instance_handle == before->info.instance_handle;
    }
    b->data[b->count] = before->data;
    b->infos[b->count] = before->info;
    struct life *l = life_of(t, &before->info);
    if (!more && l->gone == GONE_NOT) {
        item_add(b, l, b->count, gone_of(&before->info), l->time);
    }
    b->count++;
}

/* @return what was put aside for a tap, which is no longer */
static struct held held_take(const struct tap *t)
{
    struct held before = {0};
    if (held.data && held.reader == t->reader) {
        before = held;
        held.data = NULL;
    }
    return before;
}

static int order_compare(const void *one, const void *other, const void *context)
{
    const struct item *a = one, *c = other;
    (void)context;
    if (a->time != c->time) {
        return a->time < c->time ? -1 : 1;
    }
    return (a->number > c->number) - (a->number < c->number);
}

/* A key stands for the sample of which the key alone is meant. */
static void item_hand(const struct batch *b, const struct item *item, struct tap *t,
                      tap_taker *take, void *self)
{
    const dds_sample_info_t *info = &b->infos[item->sample];
    struct ddsi_serdata *data = b->data[item->sample];
    struct ddsi_serdata *key =
        item->gone != GONE_NOT && info->valid_data ? ddsi_serdata_to_untyped(data) : NULL;
    struct ddsi_serdata *shown = key ? key : data;
    ddsrt_iovec_t bytes;
    struct ddsi_serdata *ref = ddsi_serdata_to_ser_ref(shown, 0, ddsi_serdata_size(shown), &bytes);
    struct tap_sample s = {.gone = item->gone,
                           .data = bytes.iov_base,
                           .size = bytes.iov_len,
                           .source_ns = (uint64_t)item->time,
                           .writer = info->publication_handle};
    take(self, t, &s);
    ddsi_serdata_to_ser_unref(ref, &bytes);
    if (key) {
        ddsi_serdata_unref(key);
    }
}

static size_t batch_take(struct tap *t, tap_taker *take, void *self)
{
    static struct batch b;
    dds_return_t got = dds_takecdr(t->reader, b.data, TAP_BATCH, b.infos, DDS_ANY_STATE);
    size_t count = got > 0 ? (size_t)got : 0;
    struct held before = held_take(t);
    b.count = (uint32_t)count;
    b.item_count = 0;
    for (uint32_t i = 0; i < count; i++) {
        sample_look(&b, t, i);
    }
    held_look(&b, t, &before);
    mu_sort(b.items, b.item_count, sizeof b.items[0], order_compare, NULL);
    for (uint32_t i = 0; i < b.item_count; i++) {
        item_hand(&b, &b.items[i], t, take, self);
    }
    for (uint32_t i = 0; i < b.count; i++) {
        ddsi_serdata_unref(b.data[i]);
    }
    return count;
}

size_t tap_take(struct tap *tap, tap_taker *take, void *self)
{
    size_t all = 0;
    size_t count = TAP_BATCH;
    for (int i = 0; i < ROUNDS_MAX && count == TAP_BATCH && tap->reader > 0; i++) {
        count = batch_take(tap, take, self);
        all += count;
    }
    return all;
}
