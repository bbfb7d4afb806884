/* SPDX-License-Identifier: Apache-2.0 */
/* Names end, and others get their room. */
#include "broker/control/parts.h"
#include "broker/membership/membership.h"
#include "broker_story.h"
#include "disk_story.h"

enum { EXPIRY_S = 600 };

/* Takes all Deliveries, unread. */
static void collect(void)
{
    const char *process;
    muster_Delivery d;
    while (broker_next(story.b, &process, &d)) {
        broker_delivered(story.b, story.now_ns);
    }
}

static const char *name_of(unsigned i)
{
    static char name[16];
    snprintf(name, sizeof name, "r%u", i);
    return name;
}

/* Robots r0, r1, ... in processes p0, p1, ... */
static void crowd_register(unsigned first, unsigned end)
{
    char process[16];
    for (unsigned i = first; i < end; i++) {
        snprintf(process, sizeof process, "p%u", i / MU_LOCAL_AGENTS_MAX);
        story_register(name_of(i), process);
    }
    collect();
}

static void crowd_go(unsigned count)
{
    char process[16];
    for (unsigned i = 0; i < count; i += MU_LOCAL_AGENTS_MAX) {
        snprintf(process, sizeof process, "p%u", i / MU_LOCAL_AGENTS_MAX);
        story_gone(process);
    }
}

/* A broker with red and so many others of which nobody is there any more. */
static void absent_crowd(unsigned count)
{
    story_begin();
    story_join("red");
    crowd_register(0, count);
    crowd_go(count);
}

static void wait_for(unsigned seconds)
{
    story_tick(seconds * SECOND);
}

static bool is_known(const char *name)
{
    return registry_find(&story.b->registry, name) != MU_NONE;
}

static void test_names_that_are_absent_make_room(void)
{
    absent_crowd(MU_AGENTS_MAX - 1);
    CU_ASSERT_FALSE(broker_takes_names(story.b));
    wait_for(EXPIRY_S - 1);
    CU_ASSERT_FALSE(broker_takes_names(story.b));
    wait_for(1);
    CU_ASSERT_TRUE(broker_takes_names(story.b));
    CU_ASSERT_EQUAL(story.b->retirement.ended, MU_AGENTS_MAX - 1);
    CU_ASSERT_FALSE(is_known("r7"));
    crowd_register(0, MU_AGENTS_MAX - 1);
    CU_ASSERT_EQUAL(story_status().agents, MU_AGENTS_MAX);
    READS(story_member("r7"), "r7 running p0");
}

static void test_names_stay_while_there_is_room(void)
{
    absent_crowd(MU_AGENTS_MAX / 8);
    wait_for(10 * EXPIRY_S);
    CU_ASSERT_EQUAL(story.b->retirement.ended, 0);
    CU_ASSERT_TRUE(is_known("r7"));
}

/* Somebody of the crowd sends, who lives in p0. */
static void crowd_mail(muster_Mail m)
{
    struct one_up u;
    one_up(&u, m.src, "p0", &m, 1, 0);
    story_hear(&u.up);
}

static void crowd_ask(const char *src, const char *performative, const char *content)
{
    muster_Mail m = letter(src, 1, "broker", content);
    m.layer = 2;
    m.performative = words(performative);
    crowd_mail(m);
}

/* r0 has mail, r1 has sent some, r2 is in a group, r4 holds nothing. */
static void test_names_that_hold_something_stay(void)
{
    story_begin();
    story_join("red");
    story_join("blue");
    crowd_register(0, MU_AGENTS_MAX - 2);
    story_state("blue", muster_STATE_SUSPENDED);
    crowd_mail(letter("r1", 1, "blue", "m"));
    crowd_ask("r2", "group-join", "g");
    collect();
    struct one_up u;
    one_up(&u, "r2", "p0", NULL, 0, 1); /* the answer */
    story_hear(&u.up);
    crowd_go(MU_AGENTS_MAX - 2);
    story_mail(letter("red", 1, "r0", "m"));
    collect();
    CU_ASSERT_EQUAL(
        mailbox_box(&story.b->mailbox, registry_find(&story.b->registry, "r2"))->use.mails, 0);
    wait_for(EXPIRY_S);
    CU_ASSERT_TRUE(broker_takes_names(story.b));
    CU_ASSERT_TRUE(is_known("r0"));
    CU_ASSERT_TRUE(is_known("r1"));
    CU_ASSERT_TRUE(is_known("r2"));
    CU_ASSERT_FALSE(is_known("r4"));
    story_register("r0", "p0");
    story_match("p0");
    EXPECT("r0 #1 red/1 m; r0 welcome 0");
}

static void test_a_full_broker_refuses_new_names_alone(void)
{
    story_begin();
    story_join("red");
    crowd_register(0, MU_AGENTS_MAX - 1);
    story_register("more", "p-red");
    EXPECT("more: the white pages are full");
    muster_Mail m = letter("red", 1, "red,r5", "m");
    story_mail(m);
    story_match("p0");
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "r5 #1 red/1 m"));
    story_register("operator", "p-op"); /* a command comes in all the same */
    story_match("p-op");
    EXPECT("operator welcome 0");
    CU_ASSERT_FALSE(broker_takes_names(story.b));
}

/* A store has more names than come back at once: newcomers wait for their bearers. */
static void test_room_is_first_for_names_of_the_store(void)
{
    life_begin(WALL);
    for (unsigned i = 0; i < MU_AGENTS_MAX; i++) {
        struct journal_entry e = {.kind = JOURNAL_AGENT,
                                  .name = name_of(i),
                                  .agent_kind = muster_KIND_ROBOT,
                                  .reserved_seq = JOURNAL_RESERVE};
        CU_ASSERT_TRUE(durable_restore(story.b, &e));
    }
    CU_ASSERT_TRUE(broker_takes_names(story.b));
    CU_ASSERT_FALSE(is_known(name_of(MU_AGENTS_MAX - 1)));
    story_match("p-new");
    story_register_newcomer("more", "p-new", 0);
    EXPECT("more: the white pages are full");
    story_register(name_of(MU_AGENTS_MAX - 1), "p-old");
    CU_ASSERT_TRUE(is_known(name_of(MU_AGENTS_MAX - 1)));
    story_tick(1500 * MS);
    story_register_newcomer("more", "p-new", 0);
    EXPECT("more welcome 0");
}

/* What was sent before the name ended is a duplicate after it. */
static void test_numbers_outlive_a_name(void)
{
    story_begin();
    story_join("red");
    crowd_register(0, MU_AGENTS_MAX - 1);
    muster_Mail m = letter("r1", 7, "red", "one");
    crowd_mail(m);
    collect();
    story_ack("red", 1);
    crowd_go(MU_AGENTS_MAX - 1);
    wait_for(EXPIRY_S);
    CU_ASSERT_FALSE(is_known("r1"));
    story_register("r1", "p0");
    story_match("p0");
    EXPECT("r1 welcome 7");
    uint64_t duplicates = story.b->counters.duplicates_dropped;
    crowd_mail(m);
    CU_ASSERT_EQUAL(story.b->counters.duplicates_dropped, duplicates + 1);
}

/* The boxes of a broker count on: a receiver that knew the box before takes what comes. */
static void test_numbers_of_a_box_go_on(void)
{
    story_begin();
    story_join("red");
    crowd_register(0, MU_AGENTS_MAX - 1);
    muster_Mail m = letter("red", 1, "r1", "one");
    story_match("p0");
    story_mail(m);
    collect();
    struct one_up u;
    one_up(&u, "r1", "p0", NULL, 0, 1);
    story_hear(&u.up);
    collect();
    crowd_go(MU_AGENTS_MAX - 1);
    wait_for(EXPIRY_S);
    story_register("r1", "p0");
    story_match("p0");
    (void)story_collect();
    m = letter("red", 2, "r1", "two");
    story_mail(m);
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "r1 #2 red/2 two"));
}

/* --- agents that are disposed of -------------------------------------------------------------- */

static void dispose(const char *name)
{
    char process[MU_PROCESS_MAX + 1];
    snprintf(process, sizeof process, "p-%s", name);
    muster_Registration r = registration(name, process);
    entry_of(&r)->state = muster_STATE_ABSENT;
    entry_of(&r)->reason = words(muster_REASON_DISPOSED);
    broker_registration(story.b, &r, story.now_ns);
}

static bool has(const char *group)
{
    uint32_t place = 0;
    return groups_member(&story.b->pages.groups, group, true, &place) != NULL;
}

/* blue is in a group, is suspended, and has mail. */
static void test_a_disposed_name_ends_at_once(void)
{
    story_begin();
    story_join("red");
    story_join("blue");
    muster_Mail m = letter("blue", 1, "broker", "g");
    m.layer = 2;
    m.performative = words("group-join");
    story_mail(m);
    collect();
    story_ack("blue", 1);
    CU_ASSERT_TRUE(has("g"));
    story_state("blue", muster_STATE_SUSPENDED);
    story_send("red", 1, "blue", "one");
    collect();
    dispose("blue");
    CU_ASSERT_NOT_EQUAL(strstr(story_collect(), "red 1-1 dropped"), NULL);
    CU_ASSERT_FALSE(has("g"));
    story_send("red", 2, "blue", "two");
    CU_ASSERT_NOT_EQUAL(strstr(story_collect(), "red 2-2 unknown-name"), NULL);
    story_join("blue");
    story_send("red", 3, "blue", "three");
    CU_ASSERT_NOT_EQUAL(strstr(story_collect(), "red/3 three"), NULL);
    CU_ASSERT_EQUAL(story.b->retirement.ended, 0);
}

static void test_a_disposed_name_leaves_its_place(void)
{
    story_begin();
    story_join("red");
    story_join("blue");
    dispose("blue");
    story_tick(1 * SECOND);
    CU_ASSERT_TRUE(is_known("blue")); /* the other brokers are to hear of it */
    story_tick(2 * SECOND);
    CU_ASSERT_FALSE(is_known("blue"));
    CU_ASSERT_EQUAL(story.b->retirement.ending, 0);
    CU_ASSERT_PTR_NOT_NULL(graveyard_find(&story.b->registry.graveyard, "blue"));
}

/* Its last mail is still on its way. */
static void test_last_words_hold_the_place(void)
{
    story_begin();
    story_join("red");
    story_join("blue");
    story_state("red", muster_STATE_SUSPENDED);
    story_send("blue", 1, "red", "bye");
    dispose("blue");
    story_tick(10 * SECOND);
    CU_ASSERT_TRUE(is_known("blue"));
    story_state("red", muster_STATE_RUNNING);
    CU_ASSERT_NOT_EQUAL(strstr(story_collect(), "blue/1 bye"), NULL);
    story_ack("red", 1);
    story_tick(1 * SECOND);
    CU_ASSERT_FALSE(is_known("blue"));
}

/* --- the graveyard ---------------------------------------------------------------------------- */

static void test_limit_graves(void)
{
    static struct graveyard g;
    struct agent a = {.seq = {.seen = 5}};
    mu_table_init(&g.names, GRAVES_MAX);
    for (unsigned i = 0; i <= GRAVES_MAX; i++) {
        snprintf(a.name, sizeof a.name, "r%u", i);
        graveyard_bury(&g, &a);
    }
    CU_ASSERT_PTR_NULL(graveyard_find(&g, "r0")); /* begins as one that nobody has borne */
    CU_ASSERT_PTR_NOT_NULL(graveyard_find(&g, "r1"));
    a = (struct agent){.name = "r1"};
    graveyard_raise(&g, &a);
    CU_ASSERT_EQUAL(a.seq.seen, 5);
    CU_ASSERT_PTR_NULL(graveyard_find(&g, "r1"));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"absent names make room", test_names_that_are_absent_make_room},
        {"names stay while there is room", test_names_stay_while_there_is_room},
        {"names that hold something stay", test_names_that_hold_something_stay},
        {"a full broker refuses new names alone", test_a_full_broker_refuses_new_names_alone},
        {"room is first for names of the store", test_room_is_first_for_names_of_the_store},
        {"numbers outlive a name", test_numbers_outlive_a_name},
        {"numbers of a box go on", test_numbers_of_a_box_go_on},
        {"a disposed name ends at once", test_a_disposed_name_ends_at_once},
        {"a disposed name leaves its place", test_a_disposed_name_leaves_its_place},
        {"last words hold the place", test_last_words_hold_the_place},
        {"limit: graves", test_limit_graves},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/names", tests);
}
