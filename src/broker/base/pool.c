/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

#include "muster/memory.h"

/* Sizes of records, in bytes. */
const uint32_t pool_class_bytes[POOL_CLASSES] = {320,  512,  1024,  2048,
                                                 4096, 8192, 16384, POOL_RECORD_MAX};

enum { LETTER_STRINGS = 9 };

_Static_assert(sizeof(struct mail) + MU_NAME_MAX + MU_DST_MAX + 6 * MU_FIELD_MAX + MU_CONTENT_MAX +
                       LETTER_STRINGS <=
                   POOL_RECORD_MAX,
               "the largest mail fits the largest class");

void pool_init(struct pool *s)
{
    s->memory = mu_startup_array(POOL_SLABS, POOL_SLAB_BYTES);
    mu_pool_init(&s->slabs_pool, POOL_SLABS);
}

static bool slab_has_room(const struct pool_slab *slab)
{
    return slab->free || (slab->carved + 1) * pool_class_bytes[slab->size_class] <= POOL_SLAB_BYTES;
}

static struct mu_list *open_slabs(struct pool *s, uint32_t index)
{
    return &s->open[s->slabs[index].size_class];
}

/* Finds a slab of the class with room, taking a fresh one if need be. */
static uint32_t slab_open(struct pool *s, uint32_t size_class)
{
    uint32_t index = mu_list_first(&s->open[size_class]);
    if (index == MU_NONE && (index = mu_pool_take(&s->slabs_pool)) != MU_NONE) {
        s->slabs[index] = (struct pool_slab){.size_class = size_class};
        (void)mu_list_prepend(&s->open[size_class], MU_LINKS(s->slabs, link), index);
    }
    return index;
}

static void *record_at(const struct pool *s, uint32_t slab, uint32_t record)
{
    return s->memory + (size_t)slab * POOL_SLAB_BYTES +
           (size_t)record * pool_class_bytes[s->slabs[slab].size_class];
}

static void *record_take(struct pool *s, uint32_t size_class)
{
    uint32_t index = slab_open(s, size_class);
    if (index == MU_NONE) {
        return NULL;
    }
    struct pool_slab *slab = &s->slabs[index];
    void *record = slab->free;
    if (record) {
        memcpy(&slab->free, record, sizeof slab->free);
    } else {
        record = record_at(s, index, slab->carved++);
    }
    slab->live++;
    if (!slab_has_room(slab)) {
        (void)mu_list_remove(open_slabs(s, index), MU_LINKS(s->slabs, link), index);
    }
    return record;
}

void pool_free(struct pool *s, struct mail *m)
{
    uint32_t index = (uint32_t)((size_t)((unsigned char *)m - s->memory) / POOL_SLAB_BYTES);
    struct pool_slab *slab = &s->slabs[index];
    void *record = m;
    memcpy(record, &slab->free, sizeof slab->free);
    slab->free = record;
    slab->live--;
    s->mails--;
    (void)mu_list_prepend(open_slabs(s, index), MU_LINKS(s->slabs, link), index);
    if (slab->live == 0) {
        (void)mu_list_remove(open_slabs(s, index), MU_LINKS(s->slabs, link), index);
        mu_pool_give(&s->slabs_pool, index);
    }
}

struct mail *pool_put(struct pool *s, const muster_Mail *letter)
{
    static char empty[1];
    muster_Mail copy = *letter;
    char **strings[LETTER_STRINGS] = {&copy.src,         &copy.dst,          &copy.performative,
                                      &copy.language,    &copy.ontology,     &copy.reply_with,
                                      &copy.in_reply_to, &copy.conversation, &copy.content};
    size_t lengths[LETTER_STRINGS];
    size_t bytes = sizeof(struct mail);
    for (int i = 0; i < LETTER_STRINGS; i++) {
        lengths[i] = **strings[i] ? strlen(*strings[i]) : 0;
        bytes += lengths[i] ? lengths[i] + 1 : 0;
    }
    uint32_t size_class = 0;
    while (pool_class_bytes[size_class] < bytes) {
        size_class++;
        MU_ASSERT(size_class < POOL_CLASSES);
    }
    struct mail *m = record_take(s, size_class);
    if (!m) {
        return NULL;
    }
    s->mails++;
    char *text = (char *)(m + 1);
    for (int i = 0; i < LETTER_STRINGS; i++) {
        const char *from = *strings[i];
        *strings[i] = empty;
        if (lengths[i]) {
            *strings[i] = memcpy(text, from, lengths[i] + 1);
            text += lengths[i] + 1;
        }
    }
    *m = (struct mail){.letter = copy,
                       .place = {MU_NONE, MU_NONE},
                       .only = MU_NONE,
                       .uses = 1,
                       .bytes = (uint32_t)bytes,
                       .size_class = (uint8_t)size_class};
    return m;
}

struct mail *pool_each(const struct pool *s, uint32_t *place)
{
    enum { RECORDS_MAX = POOL_SLAB_BYTES / 320 }; /* of the smallest class, in one slab */
    while (*place < POOL_SLABS * RECORDS_MAX) {
        uint32_t slab = *place / RECORDS_MAX, record = *place % RECORDS_MAX;
        if (s->slabs[slab].live == 0 || record >= s->slabs[slab].carved) {
            *place = (slab + 1) * RECORDS_MAX;
            continue;
        }
        struct mail *m = record_at(s, slab, record);
        ++*place;
        if (m->uses > 0) {
            return m;
        }
    }
    return NULL;
}

struct mail *pool_list_pop(struct mail_list *list)
{
    struct mail *m = list->first;
    if (m) {
        pool_list_remove(list, m);
    }
    return m;
}

/* --- across a restart ------------------------------------------------------------------------- */

/* What can be said, or be certain, of a mail that is still in a box; FATES: its sender was told. */
static const struct {
    const char *word;
    enum mail_fate fate;
} standings[] = {
    [muster_OUTCOME_STORED] = {"stored", FATE_PASSED_ON},
    [muster_OUTCOME_EXPIRED] = {"expired", FATE_EXPIRED},
    [muster_OUTCOME_DROPPED] = {"dropped", FATE_DROPPED},
    [muster_OUTCOME_BOX_FULL] = {"box-full", FATES},
    [muster_OUTCOME_UNKNOWN_NAME] = {"unknown-name", FATES},
    [muster_OUTCOME_REFUSED] = {"refused", FATES},
};

enum { STANDINGS = sizeof standings / sizeof standings[0] };

const char *pool_mail_standing(const struct mail *m)
{
    unsigned is = m->told == TOLD_LAST ? m->answer : (unsigned)mail_outcome(m);
    return is < STANDINGS && standings[is].word ? standings[is].word : "";
}

bool pool_mail_go_on(struct mail *m, const char *word)
{
    unsigned is = 0;
    while (is < STANDINGS && (!standings[is].word || strcmp(standings[is].word, word) != 0)) {
        is++;
    }
    if (is == STANDINGS) {
        return false;
    }
    m->answer = (uint8_t)is;
    if (standings[is].fate == FATES) {
        (void)mail_tell(m, TOLD_LAST);
    } else {
        mail_meets(m, standings[is].fate);
    }
    return true;
}
