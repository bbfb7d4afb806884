/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/local_parcels.h"

#include "bus/local_frame.h"

#include <string.h>

enum kind { TEXT, EIGHT, FOUR, LEVEL, TRUTH };

/* The members of a mail as wire.idl has them. */
static const struct {
    enum kind kind;
    size_t at;
} members[] = {
    {TEXT, offsetof(muster_Mail, src)},          {EIGHT, offsetof(muster_Mail, since_wall_ns)},
    {EIGHT, offsetof(muster_Mail, seq)},         {TEXT, offsetof(muster_Mail, dst)},
    {FOUR, offsetof(muster_Mail, layer)},        {TEXT, offsetof(muster_Mail, performative)},
    {TEXT, offsetof(muster_Mail, language)},     {TEXT, offsetof(muster_Mail, ontology)},
    {TEXT, offsetof(muster_Mail, reply_with)},   {TEXT, offsetof(muster_Mail, in_reply_to)},
    {TEXT, offsetof(muster_Mail, conversation)}, {EIGHT, offsetof(muster_Mail, reply_by_ns)},
    {FOUR, offsetof(muster_Mail, priority)},     {LEVEL, offsetof(muster_Mail, level)},
    {TRUTH, offsetof(muster_Mail, again)},       {FOUR, offsetof(muster_Mail, hops)},
    {EIGHT, offsetof(muster_Mail, due_ns)},      {EIGHT, offsetof(muster_Mail, ttl_ns)},
    {TEXT, offsetof(muster_Mail, content)},
};
enum { MEMBERS = sizeof members / sizeof members[0] };

static size_t aligned(size_t at, size_t to)
{
    return (at + to - 1) & ~(to - 1);
}

/* Behind the process: the broker's life and the step; then the number of parcels stands. */
static size_t count_place(size_t behind_process)
{
    return aligned(behind_process, 8) + 16;
}

/* --- writing ---------------------------------------------------------------------------------- */

/* Makes room for so many bytes behind padding, which is zero. */
static size_t put_begin(struct local_room *room, size_t at, size_t to, size_t bytes)
{
    if (at + 8 + bytes > room->size) {
        room->size = 2 * (at + 8 + bytes);
        room->at = dds_realloc(room->at, room->size);
    }
    memset(room->at + at, 0, 8);
    return aligned(at, to);
}

static size_t four_put(struct local_room *room, size_t at, const void *from)
{
    at = put_begin(room, at, 4, 4);
    memcpy(room->at + at, from, 4);
    return at + 4;
}

static size_t eight_put(struct local_room *room, size_t at, const void *from)
{
    at = put_begin(room, at, 8, 8);
    memcpy(room->at + at, from, 8);
    return at + 8;
}

static size_t text_put(struct local_room *room, size_t at, const char *text)
{
    text = text ? text : "";
    uint32_t len = (uint32_t)strlen(text) + 1;
    at = put_begin(room, at, 4, 4 + len);
    memcpy(room->at + at, &len, 4);
    memcpy(room->at + at + 4, text, len);
    return at + 4 + len;
}

static size_t mail_put(struct local_room *room, size_t at, const muster_Mail *mail)
{
    for (size_t i = 0; i < MEMBERS; i++) {
        const char *member = (const char *)mail + members[i].at;
        switch (members[i].kind) {
        case TEXT: at = text_put(room, at, *(char *const *)(const void *)member); break;
        case EIGHT: at = eight_put(room, at, member); break;
        case FOUR:
        case LEVEL: at = four_put(room, at, member); break;
        case TRUTH:
            at = put_begin(room, at, 1, 1);
            room->at[at++] = *(const bool *)(const void *)member;
            break;
        }
    }
    return at;
}

/* Puts all parcels into what DDS has written of a Delivery with the last one alone. */
static size_t parcels_put(struct local_room *room, const muster_Delivery *d, const char *lone,
                          size_t size)
{
    uint32_t last = d->parcels._length - 1;
    const muster_Parcel *parcels = d->parcels._buffer;
    size_t count = count_place(LOCAL_HEAD + 4 + strlen(d->process) + 1);
    size_t number = aligned(count + 8 + strlen(parcels[last].box) + 1, 8);
    size_t at = put_begin(room, 0, 8, count);
    memcpy(room->at, lone, count);
    at = four_put(room, count, &d->parcels._length);
    for (uint32_t i = 0; i < last; i++) {
        at = text_put(room, at, parcels[i].box);
        at = eight_put(room, at, &parcels[i].number);
        at = mail_put(room, at, &parcels[i].letter);
    }
    /* From its number on the last one stands at multiples of 8 in both, and so does all behind. */
    at = text_put(room, at, parcels[last].box);
    at = put_begin(room, at, 8, size - number + LOCAL_HEAD);
    memcpy(room->at + at, lone + number, size - number);
    return at + size - number;
}

size_t local_parcels_write(struct bus *bus, const muster_Delivery *d, char **frame)
{
    dds_ostream_t *out = bus->room;
    muster_Delivery lone = *d;
    lone.parcels._buffer += d->parcels._length - 1;
    lone.parcels._length = lone.parcels._maximum = 1;
    out->m_index = LOCAL_HEAD;
    if (!dds_stream_write(out, (const char *)&lone, muster_Delivery_desc.m_ops)) {
        return 0;
    }
    size_t end = parcels_put(&bus->parcels, d, (const char *)out->m_buffer, out->m_index);
    *frame = bus->parcels.at;
    return end;
}

/* --- reading ---------------------------------------------------------------------------------- */

struct reading {
    const char *from;
    size_t at, size;
    bool whole;
};

/* @return where so many bytes stand, which are read then; NULL: there are none */
static const char *take(struct reading *r, size_t to, size_t bytes)
{
    size_t begin = aligned(r->at, to);
    r->whole = r->whole && begin <= r->size && bytes <= r->size - begin;
    r->at = begin + bytes;
    return r->whole ? r->from + begin : NULL;
}

static void number_take(struct reading *r, void *to, size_t bytes)
{
    const char *from = take(r, bytes, bytes);
    if (from) {
        memcpy(to, from, bytes);
    }
}

/* @return a text and, in len, its bytes with the zero; NULL: it is none */
static const char *text_find(struct reading *r, uint32_t *len)
{
    *len = 0;
    number_take(r, len, sizeof *len);
    const char *text = take(r, 1, *len);
    r->whole = r->whole && *len > 0 && text[*len - 1] == '\0';
    return r->whole ? text : NULL;
}

/* What was there before has the same memory, as with DDS. */
static void text_take(struct reading *r, char **to)
{
    uint32_t len;
    const char *text = text_find(r, &len);
    if (text) {
        if (!*to || strlen(*to) + 1 < len) {
            *to = dds_realloc(*to, len);
        }
        memcpy(*to, text, len);
    }
}

static void mail_take(struct reading *r, muster_Mail *mail)
{
    for (size_t i = 0; i < MEMBERS; i++) {
        void *member = (char *)mail + members[i].at;
        unsigned char truth = 0;
        uint32_t level = 0;
        switch (members[i].kind) {
        case TEXT: text_take(r, member); break;
        case EIGHT: number_take(r, member, 8); break;
        case FOUR: number_take(r, member, 4); break;
        case LEVEL:
            number_take(r, &level, sizeof level);
            r->whole = r->whole && level <= muster_LEVEL_SYNCED;
            mail->level = (muster_Level)level;
            break;
        case TRUTH:
            number_take(r, &truth, sizeof truth);
            r->whole = r->whole && truth <= 1;
            mail->again = truth;
            break;
        }
    }
}

static bool parcels_room(muster_Delivery *d, uint32_t count)
{
    dds_sequence_muster_Parcel *all = &d->parcels;
    if (all->_length > all->_maximum) {
        all->_maximum = all->_length;
    }
    if (count > all->_maximum && (all->_release || all->_maximum == 0)) {
        all->_buffer = dds_realloc(all->_buffer, count * sizeof *all->_buffer);
        memset(all->_buffer + all->_maximum, 0, (count - all->_maximum) * sizeof *all->_buffer);
        all->_maximum = count;
        all->_release = true;
    }
    return count <= all->_maximum;
}

/* Puts before the last parcel, which begins at r, what stands before the first. */
static char *lone_make(struct local_room *room, struct reading *r, size_t count, uint32_t *size)
{
    uint32_t len, one = 1;
    const char *box = text_find(r, &len);
    size_t number = aligned(r->at, 8);
    if (!box || number > r->size) {
        return NULL;
    }
    size_t at = put_begin(room, 0, 8, count + len + r->size);
    memcpy(room->at, r->from, count);
    at = four_put(room, count, &one);
    at = text_put(room, at, box);
    at = put_begin(room, at, 8, r->size - number);
    memcpy(room->at + at, r->from + number, r->size - number);
    *size = (uint32_t)(at + r->size - number);
    return room->at;
}

char *local_parcels_take(struct local_room *room, muster_Delivery *d, char *body, uint32_t *size,
                         uint32_t *others)
{
    enum { PARCEL_LEAST = 64 }; /* bytes of an empty one, and fewer */
    struct reading r = {.from = body, .size = *size, .whole = true};
    uint32_t len, count = 0;
    (void)text_find(&r, &len);
    size_t place = count_place(r.at);
    (void)take(&r, 8, 16);
    number_take(&r, &count, sizeof count);
    *others = count > 1 ? count - 1 : 0;
    if (!r.whole || *others == 0) {
        return r.whole ? body : NULL;
    }
    if (count > *size / PARCEL_LEAST || !parcels_room(d, count)) {
        return NULL;
    }
    for (uint32_t i = 1; i < count && r.whole; i++) {
        text_take(&r, &d->parcels._buffer[i].box);
        number_take(&r, &d->parcels._buffer[i].number, 8);
        mail_take(&r, &d->parcels._buffer[i].letter);
    }
    return r.whole ? lone_make(room, &r, place, size) : NULL;
}

void local_parcels_join(muster_Delivery *d, uint32_t others)
{
    muster_Parcel *all = d->parcels._buffer, last = all[0];
    memmove(all, all + 1, others * sizeof *all);
    all[others] = last;
    d->parcels._length = others + 1;
}
