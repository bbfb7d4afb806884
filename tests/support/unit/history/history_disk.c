/* SPDX-License-Identifier: Apache-2.0 */
/* The disk: what was committed, and nothing else, is there in the next life. */
#include "history.h"

#include "../platter.h"

#include <stdlib.h>
#include <string.h>

static struct platter platter;

void disk_clear(void)
{
    memset(&platter, 0, sizeof platter);
}

void disk_write(void)
{
    struct journal_entry e = {.name = NULL};
    muster_Level level;
    if (!journal_wanted(history.life.b, &level)) {
        return;
    }
    bool works = !history.life.disk_fails;
    while (journal_next(history.life.b, &e)) {
        HOLD(!works || platter_write(&platter, &e));
    }
    history_note("%s", works ? "committed" : "the disk does not take it");
    durable_committed(history.life.b, works, life_now_ns());
    ledger_committed(works);
    if (works) {
        history.book_on_disk = history.book;
    }
}

/* --- the next life ---------------------------------------------------------------------------- */

static void restore(const struct journal_entry *e)
{
    bool taken = durable_restore(history.life.b, e);
    if (!taken) {
        history_note("entry of kind %d, of %s/%llu for %s, is not taken", (int)e->kind,
                     e->letter.src ? e->letter.src : "", (unsigned long long)e->letter.seq,
                     e->waiting ? e->waiting : "");
    }
    bool is_mail = e->kind == JOURNAL_MAIL;
    uint32_t mail = is_mail ? (uint32_t)strtoul(e->letter.content, NULL, 10) : 0;
    /* Two of one name can have given two mails one number. */
    HOLD(taken || (is_mail && history.contested[history.ledger[mail].sender_life]));
}

void disk_restore(void)
{
    platter_read(&platter, restore);
}
