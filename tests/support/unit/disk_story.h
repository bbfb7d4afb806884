/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file disk_story.h
 * A broker_story.h with a disk that is an array, and with brokers that die and come back.
 */
#ifndef MUSTER_TESTS_DISK_STORY_H
#define MUSTER_TESTS_DISK_STORY_H

#include "broker/control/parts.h"
#include "broker/mail/mail.h"
#include "broker_story.h"
#include "platter.h"

#define SECOND 1000000000ull
#define WALL   1000000000000000000ull

static struct platter disk;   /* what is on it */
static uint64_t wall_ns;      /* when this life began */
static muster_Level level;    /* of the last commit */
static uint32_t writes;       /* entries of the last commit */
static uint32_t lines_resets; /* ever */

/* --- the disk --------------------------------------------------------------------------------- */

/* @return whether there was anything to write */
static inline bool commit(bool works)
{
    struct journal_entry e = {.name = NULL};
    writes = 0;
    if (!journal_wanted(story.b, &level)) {
        return false;
    }
    while (journal_next(story.b, &e)) {
        writes++;
        lines_resets += e.kind == JOURNAL_RESET;
        if (works) {
            CU_ASSERT_TRUE_FATAL(platter_write(&disk, &e));
        }
    }
    durable_committed(story.b, works, story.now_ns);
    return true;
}

/* --- lives ------------------------------------------------------------------------------------ */

static inline void life_begin(uint64_t at_wall_ns)
{
    struct broker_options options = {.name = "alpha",
                                     .incarnation = at_wall_ns,
                                     .pid = 9,
                                     .wall_ns = at_wall_ns,
                                     .has_store = true};
    story.b = broker_kept(&options);
    story.now_ns = 0;
    wall_ns = at_wall_ns;
    mu_text_init(&story.text, story.buffer, sizeof story.buffer);
}

static uint32_t refused;

static inline void come_back(const struct journal_entry *e)
{
    refused += !durable_restore(story.b, e);
}

/* The broker dies now, and is back later. */
static inline void die_and_come_back(uint64_t later_ns)
{
    life_begin(wall_ns + story.now_ns + later_ns);
    refused = 0;
    platter_read(&disk, come_back);
}

/* A new team on a new disk; green and blue have been there and are gone. */
static inline void team(void)
{
    memset(&disk, 0, sizeof disk);
    life_begin(WALL);
    story_join("red");
    story_join("green");
    story_join("blue");
    CU_ASSERT_TRUE(commit(true));
    story_gone("p-green");
    story_gone("p-blue");
    (void)story_collect();
    CU_ASSERT_FALSE(commit(true));
}

/* A team, and rita, who says whom near: stands for. */
static inline void team_with_resolver(void)
{
    team();
    story_join("rita");
    muster_Mail offer = letter("rita", 1, "broker", "resolver \"scheme=near\"");
    offer.layer = 2;
    offer.performative = words("advertise");
    story_mail(offer);
    (void)story_collect();
    CU_ASSERT_TRUE(commit(true));
}

/* rita answers the first question of a broker's life. */
static inline void resolve_as(const char *names)
{
    muster_Mail answer = letter("rita", 2, "broker", names);
    answer.layer = 2;
    answer.performative = words("inform");
    answer.in_reply_to = words("resolve-4611686018427387905");
    story_mail(answer);
}

static inline void send_at(muster_Level at, uint64_t seq, const char *dst, const char *content)
{
    muster_Mail m = letter("red", seq, dst, content);
    m.level = at;
    story_mail(m);
}

static inline void log_mail(uint64_t seq, const char *dst, const char *content)
{
    send_at(muster_LEVEL_LOGGED, seq, dst, content);
}

static inline void again(uint64_t seq, muster_Level at)
{
    muster_Mail m = letter("red", seq, "green", "again");
    m.level = at;
    m.again = true;
    story_mail(m);
}

#endif
