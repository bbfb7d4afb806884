/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file circular_story.h
 * A broker_story.h with a crowd in it that hears multicasts: red speaks to a, b, c and so on, each
 * in a process of his own.
 */
#ifndef MUSTER_TESTS_CIRCULAR_STORY_H
#define MUSTER_TESTS_CIRCULAR_STORY_H

#include "disk_story.h"

#define SOME_MS   (20 * MS)
#define RESEND_MS (1000 * MS)

static const char *const crew[] = {"a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l"};

static struct {
    uint64_t seq; /* of red's last mail */
    uint32_t count;
} crowd;

static inline const char *process_of(const char *name)
{
    static char process[MU_PROCESS_MAX + 1];
    snprintf(process, sizeof process, "p-%s", name);
    return process;
}

static inline struct process *place_at(const char *process)
{
    uint32_t place = processes_find(&story.b->processes, process);
    CU_ASSERT_NOT_EQUAL_FATAL(place, MU_NONE);
    return &story.b->processes.at[place];
}

static inline void say_as(muster_Mail m)
{
    m.seq = ++crowd.seq;
    story_mail(m);
}

static inline void say(const char *dst, const char *content)
{
    say_as(letter("red", 0, dst, content));
}

static inline void acknowledge(uint64_t number)
{
    for (uint32_t i = 0; i < crowd.count; i++) {
        story_ack(crew[i], number);
    }
}

/* Everybody has had one mail, and with it the seat of his process. */
static inline void greet(void)
{
    for (uint32_t i = 0; i < crowd.count; i++) {
        broker_hears(story.b, process_of(crew[i]));
        say(crew[i], "hello");
    }
    (void)story_collect();
    acknowledge(1);
    (void)story_collect();
}

static inline void crowd_join(uint32_t count)
{
    crowd.seq = 0;
    crowd.count = count;
    story_join("red");
    for (uint32_t i = 0; i < count; i++) {
        story_join(crew[i]);
    }
    (void)story_collect();
}

/* So many agents, each in a process of its own that hears multicasts; red is one more, who does
 * not.
 */
static inline void crowd_of(uint32_t count)
{
    story_begin();
    crowd_join(count);
    greet();
}

/* Everything that was sent has come to an end, and whatever came to a process was the next. */
static inline void all_is_over(void)
{
    CU_ASSERT_EQUAL(story_status().waiting, 0);
    CU_ASSERT_EQUAL(story_status().stored, 0);
    CU_ASSERT_EQUAL(story.b->multicast.count, 0);
    CU_ASSERT_EQUAL(story.b->mailbox.posts_pool.live, 0);
    CU_ASSERT_EQUAL(story.gaps, 0);
}

#endif
