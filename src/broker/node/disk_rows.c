/* SPDX-License-Identifier: Apache-2.0 */
/* What the journal has to write, as rows, and rows as what it takes back. */

#include "broker/node/disk_parts.h"

#include <stddef.h>
#include <string.h>

/* --- the records ------------------------------------------------------------------------------ */

enum field_type {
    FIELD_TEXT,
    FIELD_NUMBER, /* uint64_t; its highest bit comes back as it was, by way of a negative one */
    FIELD_LEASE,  /* the same; 0 takes no room */
    FIELD_DUE,    /* int64_t, plus 1 */
    FIELD_SMALL,  /* uint32_t or an enum */
    FIELD_SIGNED, /* int32_t */
    FIELD_FLAG,   /* bool */
    FIELD_KIND,   /* the word for a muster_Kind */
    FIELD_LINES,  /* the word for an enum lines_kind */
};

/* A column, and what it is in struct journal_entry. */
struct field {
    enum field_type type;
    size_t offset;
};

#define AT(member) offsetof(struct journal_entry, member)

static const struct field agent[] = {{FIELD_TEXT, AT(name)},
                                     {FIELD_KIND, AT(agent_kind)},
                                     {FIELD_NUMBER, AT(durable_seq)},
                                     {FIELD_NUMBER, AT(reserved_seq)},
                                     {FIELD_NUMBER, AT(failed_seq)}};

static const struct field line[] = {
    {FIELD_LINES, AT(lines)},         {FIELD_SMALL, AT(slot)},
    {FIELD_TEXT, AT(line.key)},       {FIELD_TEXT, AT(line.agent)},
    {FIELD_FLAG, AT(line.present)},   {FIELD_TEXT, AT(line.attributes)},
    {FIELD_LEASE, AT(line.lease_ns)}, {FIELD_NUMBER, AT(line.stamp_ns)},
    {FIELD_TEXT, AT(line.origin)}};

static const struct field run_clock[] = {{FIELD_NUMBER, AT(run_wall_ns)}};

static const struct field snapshot[] = {
    {FIELD_TEXT, AT(name)}, {FIELD_NUMBER, AT(epoch)}, {FIELD_TEXT, AT(snapshot)}};

static const struct field waiting[] = {{FIELD_NUMBER, AT(row)}, {FIELD_TEXT, AT(waiting)}};

/* Its number, then the list in which its bundle has it: first what every mail has. */
enum { MAIL_LIST = 1, MAIL_RARE = 9 };
static const struct field mail[] = {
    {FIELD_NUMBER, AT(row)},
    {FIELD_TEXT, AT(letter.src)},
    {FIELD_NUMBER, AT(letter.seq)},
    {FIELD_TEXT, AT(waiting)},
    {FIELD_SMALL, AT(letter.level)},
    {FIELD_TEXT, AT(letter.dst)},
    {FIELD_SMALL, AT(letter.layer)},
    {FIELD_TEXT, AT(letter.performative)},
    {FIELD_TEXT, AT(letter.content)},
    [MAIL_RARE] = {FIELD_NUMBER, AT(expires_wall_ns)},
    {FIELD_TEXT, AT(letter.language)},
    {FIELD_TEXT, AT(letter.ontology)},
    {FIELD_TEXT, AT(letter.reply_with)},
    {FIELD_TEXT, AT(letter.in_reply_to)},
    {FIELD_TEXT, AT(letter.conversation)},
    {FIELD_NUMBER, AT(letter.reply_by_ns)},
    {FIELD_SIGNED, AT(letter.priority)},
    {FIELD_SMALL, AT(letter.hops)},
    {FIELD_DUE, AT(letter.due_ns)},
    {FIELD_NUMBER, AT(letter.ttl_ns)},
};
enum { MAIL_FIELDS = sizeof mail / sizeof mail[0] };

static const struct field *const records[] = {
    [JOURNAL_AGENT] = agent,      [JOURNAL_MAIL] = mail,  [JOURNAL_WAITING] = waiting,
    [JOURNAL_LINE] = line,        [JOURNAL_RESET] = line, [JOURNAL_CLOCK] = run_clock,
    [JOURNAL_SNAPSHOT] = snapshot};

/* --- values ----------------------------------------------------------------------------------- */

static const char ENDED[] = "ended"; /* the kind of a name that has ended */

/* @return the word for a number, or NULL: there is none */
static const char *word_of(enum field_type type, uint32_t number)
{
    static const char *const lines[LINES_KINDS + 1] = {
        [LINES_GROUPS] = "group", [LINES_SERVICES] = "service"};
    if (type == FIELD_LINES) {
        return lines[number];
    }
    return number == JOURNAL_ENDED ? ENDED : validate_kind_word((muster_Kind)number);
}

/* What a field has: a text, or, if that is NULL, a number. */
struct value {
    const char *text;
    uint64_t number;
};

static struct value value_of(const struct field *f, const struct journal_entry *e)
{
    const char *at = (const char *)e + f->offset;
    struct value v = {.text = NULL};
    uint32_t small = 0;
    bool flag = false;
    switch (f->type) {
    case FIELD_TEXT:
        memcpy(&v.text, at, sizeof v.text);
        return (struct value){v.text ? v.text : "", 0};
    case FIELD_NUMBER:
    case FIELD_LEASE:
    case FIELD_DUE: memcpy(&v.number, at, sizeof v.number); break;
    case FIELD_FLAG: memcpy(&flag, at, sizeof flag); break;
    case FIELD_SMALL:
    case FIELD_SIGNED:
    case FIELD_KIND:
    case FIELD_LINES: memcpy(&small, at, sizeof small); break;
    }
    if (f->type == FIELD_KIND || f->type == FIELD_LINES) {
        v.text = word_of(f->type, small);
    }
    v.number += f->type == FIELD_SIGNED ? (uint64_t)(int32_t)small : small;
    v.number += (uint64_t)flag + (f->type == FIELD_DUE);
    return v;
}

/* A word that is none of these is the last kind of lines, and the first of agents. */
static uint32_t word_read(enum field_type type, const char *word)
{
    uint32_t i = 0;
    while (word_of(type, i) && strcmp(word_of(type, i), word) != 0) {
        i++;
    }
    bool known = word_of(type, i) || type == FIELD_LINES;
    return known ? i : strcmp(word, ENDED) == 0 ? (uint32_t)JOURNAL_ENDED : 0;
}

static void field_read(const struct field *f, sqlite3_stmt *s, int column, struct journal_entry *e)
{
    char *at = (char *)e + f->offset;
    const char *text = (const char *)sqlite3_column_text(s, column);
    text = text ? text : "";
    uint64_t number = (uint64_t)sqlite3_column_int64(s, column) - (f->type == FIELD_DUE);
    uint32_t small = (uint32_t)number;
    bool flag = number != 0;
    switch (f->type) {
    case FIELD_TEXT: memcpy(at, &text, sizeof text); break;
    case FIELD_NUMBER:
    case FIELD_LEASE:
    case FIELD_DUE: memcpy(at, &number, sizeof number); break;
    case FIELD_FLAG: memcpy(at, &flag, sizeof flag); break;
    case FIELD_KIND:
    case FIELD_LINES:
        small = word_read(f->type, text);
        memcpy(at, &small, sizeof small);
        break;
    case FIELD_SMALL:
    case FIELD_SIGNED: memcpy(at, &small, sizeof small); break;
    }
}

/* --- rows ------------------------------------------------------------------------------------- */

/* What is empty takes no room.  Texts must stay until the statement has run. */
bool disk_row_put(sqlite3_stmt *s, const struct journal_entry *e)
{
    for (int i = 0; i < sqlite3_bind_parameter_count(s); i++) {
        const struct field *f = &records[e->kind][i];
        struct value v = value_of(f, e);
        if (v.text ? v.text[0] == '\0' : f->type == FIELD_LEASE && v.number == 0) {
            sqlite3_bind_null(s, i + 1);
        } else if (v.text) {
            sqlite3_bind_text(s, i + 1, v.text, -1, SQLITE_STATIC);
        } else {
            sqlite3_bind_int64(s, i + 1, (int64_t)v.number);
        }
    }
    return disk_step(s);
}

void disk_row_take(sqlite3_stmt *s, struct journal_entry *e)
{
    for (int i = 0; i < sqlite3_column_count(s); i++) {
        field_read(&records[e->kind][i], s, i, e);
    }
}

/* --- a mail as JSON --------------------------------------------------------------------------- */

/* What must not stand in a string as it is, such as a quote, is written by its code. */
static void add_coded(struct mu_text *t, char c)
{
    char quoted[2] = {'\\', c};
    if (c == '"' || c == '\\') {
        mu_text_add_bytes(t, quoted, sizeof quoted);
    } else {
        mu_text_format(t, "\\u%04x", (unsigned)(unsigned char)c);
    }
}

/* What is no UTF-8 stays as it is, too: SQLite gives it back. */
static void add_string(struct mu_text *t, const char *s)
{
    mu_text_add_bytes(t, "\"", 1);
    for (;;) {
        size_t plain = 0;
        while ((unsigned char)s[plain] >= ' ' && s[plain] != '"' && s[plain] != '\\') {
            plain++;
        }
        mu_text_add_bytes(t, s, plain);
        s += plain;
        if (*s == '\0') {
            break;
        }
        add_coded(t, *s++);
    }
    mu_text_add_bytes(t, "\"", 1);
}

/* @return whether any field of a mail, from MAIL_RARE on, has anything */
static bool mail_is_rare(const struct journal_entry *e)
{
    bool rare = false;
    for (int i = MAIL_RARE; i < MAIL_FIELDS && !rare; i++) {
        struct value v = value_of(&mail[i], e);
        rare = v.text ? v.text[0] != '\0' : v.number > 0;
    }
    return rare;
}

void disk_row_add_mail(struct mu_text *t, const struct journal_entry *e)
{
    int count = mail_is_rare(e) ? MAIL_FIELDS : MAIL_RARE; /* what is left out is empty, or 0 */
    mu_text_add(t, t->len ? ",\n[" : "[[");
    for (int i = MAIL_LIST; i < count; i++) {
        struct value v = value_of(&mail[i], e);
        mu_text_add(t, i > MAIL_LIST ? "," : "");
        if (v.text) {
            add_string(t, v.text);
        } else {
            mu_text_add_number(t, (long long)v.number);
        }
    }
    mu_text_add_bytes(t, "]", 1);
}
