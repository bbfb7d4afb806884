/* SPDX-License-Identifier: Apache-2.0 */
/* Processes with many agents: parts, slots, and what one Delivery holds. */
#include "broker/control/parts.h"
#include "broker_story.h"
#include "bus/check.h"

enum { CROWD = 10000 };

static muster_Entry entries[MU_PART_AGENTS];
static char names[MU_PART_AGENTS][MU_NAME_MAX + 1];

/* Part of a process in which the agent of slot N is called aN. */
static muster_Registration part_of(const char *process, uint32_t part, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        snprintf(names[i], sizeof names[i], "a%u", part * MU_PART_AGENTS + i);
        entries[i] = (muster_Entry){.reason = words(""),
                                    .name = names[i],
                                    .kind = muster_KIND_AGENT,
                                    .state = muster_STATE_RUNNING,
                                    .home = words("")};
    }
    muster_Registration r = {.wire = muster_WIRE,
                             .process = words(process),
                             .part = part,
                             .broker = words(""),
                             .incarnation = 1,
                             .host = words("here"),
                             .pid = 1};
    r.agents._buffer = entries;
    r.agents._length = r.agents._maximum = count;
    return r;
}

static void part_say(const muster_Registration *r)
{
    broker_registration(story.b, r, story.now_ns);
}

static void crowd_register(const char *process, uint32_t agents)
{
    for (uint32_t first = 0; first < agents; first += MU_PART_AGENTS) {
        uint32_t left = agents - first;
        muster_Registration r =
            part_of(process, first / MU_PART_AGENTS, left < MU_PART_AGENTS ? left : MU_PART_AGENTS);
        part_say(&r);
    }
}

/* What all deliveries together had, and the most in one. */
static struct {
    uint32_t deliveries, welcomes, refusals, members, roll_calls;
    uint32_t welcomes_most, members_most;
} got;

static uint32_t larger(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

static void collect(void)
{
    const char *process;
    muster_Delivery d;
    memset(&got, 0, sizeof got);
    while (broker_next(story.b, &process, &d)) {
        uint32_t welcomes = 0;
        for (uint32_t i = 0; i < d.verdicts._length; i++) {
            welcomes += d.verdicts._buffer[i].accepted;
        }
        got.deliveries++;
        got.welcomes += welcomes;
        got.refusals += d.verdicts._length - welcomes;
        got.members += d.members._length;
        got.roll_calls += d.roll_call;
        got.welcomes_most = larger(got.welcomes_most, welcomes);
        got.members_most = larger(got.members_most, d.members._length);
        broker_delivered(story.b, story.now_ns);
    }
}

static void test_ten_thousand_agents(void)
{
    story_begin();
    story_match("p");
    crowd_register("p", CROWD);
    collect();
    CU_ASSERT_EQUAL(story_status().agents, CROWD);
    CU_ASSERT_EQUAL(got.welcomes, CROWD);
    CU_ASSERT_EQUAL(got.members, CROWD + MU_BROKER_LINES);
    CU_ASSERT_EQUAL(got.welcomes_most, DISPATCH_AGENTS);
    CU_ASSERT_EQUAL(got.members_most, DISPATCH_MEMBERS);
    CU_ASSERT_EQUAL(got.roll_calls, 0);
    crowd_register("p", CROWD); /* nothing new */
    collect();
    CU_ASSERT_EQUAL(got.deliveries, 0);
    for (uint32_t i = 0; i < CROWD; i += 500) {
        muster_Registration r = part_of("p", i / MU_PART_AGENTS, MU_PART_AGENTS);
        entries[i % MU_PART_AGENTS].state = muster_STATE_SUSPENDED;
        part_say(&r);
    }
    collect();
    CU_ASSERT_EQUAL(got.members, CROWD / 500);
    story_gone("p");
    CU_ASSERT_EQUAL(story_status().agents, 0);
}

static void test_mail_to_ten_thousand(void)
{
    story_begin();
    story_join("red");
    story_match("p");
    crowd_register("p", CROWD);
    collect();
    story_send("red", 1, "all", "hello");
    const char *process;
    muster_Delivery d;
    uint32_t parcels = 0, most = 0;
    static bool had[CROWD];
    memset(had, 0, sizeof had);
    while (broker_next(story.b, &process, &d)) {
        for (uint32_t i = 0; i < d.parcels._length; i++) {
            unsigned long agent = strtoul(d.parcels._buffer[i].box + 1, NULL, 10);
            CU_ASSERT_FATAL(agent < CROWD && !had[agent]);
            had[agent] = true;
        }
        parcels += d.parcels._length;
        most = larger(most, d.parcels._length);
        broker_delivered(story.b, 0);
    }
    CU_ASSERT_EQUAL(parcels, CROWD);
    CU_ASSERT_EQUAL(most, MU_WINDOW_MAX);
    CU_ASSERT_EQUAL(story_status().waiting, CROWD);
}

static void test_an_agent_leaves_its_slot(void)
{
    story_begin();
    story_match("p");
    muster_Registration r = part_of("p", 0, 3);
    part_say(&r);
    EXPECT("a0 welcome 0; a1 welcome 0; a2 welcome 0");
    entries[1].state = muster_STATE_ABSENT;
    part_say(&r);
    CU_ASSERT_STRING_EQUAL(story_member("a1"), "a1 absent p");
    CU_ASSERT_STRING_EQUAL(story_member("a2"), "a2 running p");
    EXPECT("");
    r = part_of("p", 0, 4); /* it comes back in another slot, and its old one says so still */
    entries[3].name = words("a1");
    entries[1].state = muster_STATE_ABSENT;
    part_say(&r);
    EXPECT("a1 welcome 0");
    part_say(&r);
    CU_ASSERT_STRING_EQUAL(story_member("a1"), "a1 running p");
    entries[2].name = words("other"); /* a slot has one agent */
    part_say(&r);
    CU_ASSERT_STRING_EQUAL(story_member("a2"), "a2 absent p");
    EXPECT("other welcome 0");
}

static void test_a_part_is_taken_back(void)
{
    story_begin();
    story_match("p");
    crowd_register("p", 3 * MU_PART_AGENTS);
    (void)story_collect();
    broker_gone(story.b, "p", 1, false, 0);
    CU_ASSERT_EQUAL(story_status().agents, 2 * MU_PART_AGENTS);
    CU_ASSERT_STRING_EQUAL(story_member("a64"), "a64 absent p");
    CU_ASSERT_STRING_EQUAL(story_member("a128"), "a128 running p");
    broker_gone(story.b, "p", 4000000000u, false, 0);
    broker_gone(story.b, "nobody", 0, true, 0);
    CU_ASSERT_EQUAL(story_status().agents, 2 * MU_PART_AGENTS);
    broker_gone(story.b, "p", 2, true, 0); /* nobody writes any more: all of it */
    CU_ASSERT_EQUAL(story_status().agents, 0);
}

/* Stopped and continued, only its heartbeat is heard: it is asked for the rest. */
static void test_who_was_lost_is_called(void)
{
    story_begin();
    story_match("p");
    crowd_register("p", 100);
    (void)story_collect();
    story_gone("p");
    (void)story_collect();
    crowd_register("p", MU_PART_AGENTS); /* part 0 */
    CU_ASSERT_EQUAL(story_status().agents, MU_PART_AGENTS);
    collect();
    CU_ASSERT_EQUAL(got.roll_calls, 1);
    crowd_register("p", 100);
    CU_ASSERT_EQUAL(story_status().agents, 100);
    collect();
    CU_ASSERT_EQUAL(got.roll_calls, 0);
    CU_ASSERT_EQUAL(got.welcomes, 100 - MU_PART_AGENTS);
}

/* It need not wait for a heartbeat of one that speaks. */
static void test_who_was_missed_and_speaks_is_called(void)
{
    story_begin();
    story_join("red");
    story_join("blue");
    (void)story_collect();
    story_send("red", 1, "blue", "here");
    CU_ASSERT_PTR_NULL(strstr(story_collect(), "roll call"));
    story_gone("p-red");
    CU_ASSERT_PTR_NULL(strstr(story_collect(), "roll call"));
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-red");
    story_send("red", 2, "blue", "still here");
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "roll call"));
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-red"); /* until it answers */
    story_register("red", "p-red");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-red");
    (void)story_collect();
    story_send("red", 3, "blue", "back");
    CU_ASSERT_PTR_NULL(strstr(story_collect(), "roll call"));
}

static void test_bad_names_hurt_nobody_else(void)
{
    static char long_name[10001];
    static const struct {
        const char *name;
        const char *refusal;
    } bad[] = {{"a b", "a b: not a valid name"},
               {"a\"b", "a\"b: not a valid name"},
               {"a\nb", "a\nb: not a valid name"},
               {"a*", "a*: not a valid name"},
               {"", ": not a valid name"},
               {"\xff\xc3-", "?\?-: not a valid name"},
               {"\xc3\xa9t\xc3\xa9", "\xc3\xa9t\xc3\xa9: not a valid name"},
               {long_name, NULL}};
    memset(long_name, 'n', sizeof long_name - 1);
    story_begin();
    story_match("p");
    (void)story_collect();
    for (uint32_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        muster_Registration r = part_of("p", 0, 3);
        entries[1].name = words(bad[i].name);
        part_say(&r);
        CU_ASSERT_EQUAL(story_status().malformed, i + 1);
        CU_ASSERT_EQUAL(story_status().agents, 2);
        const char *text = story_collect();
        if (bad[i].refusal) {
            CU_ASSERT_PTR_NOT_NULL(strstr(text, bad[i].refusal));
        } else {
            char cut[MU_PROCESS_MAX + 32];
            snprintf(cut, sizeof cut, "%.*s: not a", MU_PROCESS_MAX, long_name);
            CU_ASSERT_PTR_NOT_NULL(strstr(text, cut));
        }
    }
    CU_ASSERT_STRING_EQUAL(story_member("a0"), "a0 running p");
}

static void test_limit_refusals(void)
{
    story_begin();
    story_match("p");
    (void)story_collect();
    for (uint32_t part = 0; part < 2; part++) {
        muster_Registration r = part_of("p", part, MU_PART_AGENTS);
        for (uint32_t i = 0; i < MU_PART_AGENTS; i++) {
            names[i][0] = '9';
        }
        part_say(&r);
    }
    collect();
    CU_ASSERT_EQUAL(got.refusals, PROCESSES_REFUSALS);
    CU_ASSERT_EQUAL(got.roll_calls, 1); /* it hears of the others when it has said them again */
}

static void test_limit_parts(void)
{
    story_begin();
    story_match("p");
    (void)story_collect();
    muster_Registration r = part_of("p", PROCESSES_PARTS - 1, MU_PART_AGENTS);
    part_say(&r);
    CU_ASSERT_EQUAL(story_status().agents, MU_PART_AGENTS);
    CU_ASSERT_TRUE(check_registration(&r));
    r.part = PROCESSES_PARTS;
    CU_ASSERT_FALSE(check_registration(&r));
}

static void test_a_registration_for_another_broker(void)
{
    story_begin();
    story_match("p");
    muster_Registration r = part_of("p", 0, 2);
    r.broker = words("alpha");
    part_say(&r);
    CU_ASSERT_EQUAL(story_status().agents, 2);
    r.broker = words("beta"); /* it has gone there */
    part_say(&r);
    CU_ASSERT_EQUAL(story_status().agents, 0);
    CU_ASSERT_EQUAL(story_status().malformed, 0);
}

static void test_agents_that_live_elsewhere(void)
{
    muster_Member m;
    story_begin();
    muster_Registration r = part_of("broker.gamma", 0, 1);
    r.is_broker = true;
    entries[0].home = words("beta");
    entries[0].via = entries[0].host = words("");
    entries[0].hops = 1;
    part_say(&r);
    CU_ASSERT_TRUE(broker_member(story.b, 0, &m));
    CU_ASSERT_STRING_EQUAL(m.name, "a0");
    CU_ASSERT_STRING_EQUAL(m.broker, "beta");
    const struct presence *is =
        &story.b->registry.agents[registry_find(&story.b->registry, "a0")].is;
    CU_ASSERT_EQUAL(is->hops, 2);
    uint32_t gamma = processes_find(&story.b->processes, "broker.gamma");
    CU_ASSERT_EQUAL(story.b->processes.at[gamma].kind, PROCESS_BROKER);
    entries[0].home = words("no name");
    part_say(&r);
    CU_ASSERT_EQUAL(story_status().malformed, 1);
}

static void test_limits_of_a_box_are_carried(void)
{
    story_begin();
    muster_Registration r = part_of("p", 0, 1);
    entries[0].full = muster_BOX_DROP_OLDEST;
    entries[0].box_mails = 5;
    entries[0].box_bytes = 700;
    part_say(&r);
    const struct presence *is =
        &story.b->registry.agents[registry_find(&story.b->registry, "a0")].is;
    CU_ASSERT_EQUAL(is->box.policy, muster_BOX_DROP_OLDEST);
    CU_ASSERT_EQUAL(is->box.mails, 5);
    CU_ASSERT_EQUAL(is->box.bytes, 700);
    entries[0].box_mails = 6;
    part_say(&r);
    CU_ASSERT_EQUAL(is->box.mails, 6);
}

/* Ten thousand names go from one process to the next, at once when the first is gone. */
static void test_a_crowd_is_inherited(void)
{
    story_begin();
    story_match("old");
    story_match("new");
    crowd_register("old", CROWD);
    collect();
    crowd_register("new", CROWD);
    collect();
    CU_ASSERT_EQUAL(got.welcomes, 0);
    story_gone("old");
    collect();
    CU_ASSERT_EQUAL(got.welcomes, CROWD);
    CU_ASSERT_EQUAL(story_status().agents, CROWD);
    CU_ASSERT_STRING_EQUAL(story_member("a77"), "a77 running new");
    crowd_register("old", 100);
    broker_gone(story.b, "old", 0, false, 0);
    CU_ASSERT_EQUAL(story.b->processes.at[processes_find(&story.b->processes, "old")].claims,
                    100 - MU_PART_AGENTS);
    story_gone("old");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), UINT64_MAX);
}

/* All agents of a process have something acknowledged, and one behind a Delivery's worth of them
 * has mail. */
static void test_mail_behind_many_that_have_none(void)
{
    enum { MANY = DISPATCH_AGENTS + 100 };
    static muster_Ack acks[MANY];
    static char box[MANY][MU_NAME_MAX + 1];
    const char *process;
    muster_Delivery d;
    uint32_t mails = 0;
    story_begin();
    story_join("red");
    crowd_register("p-many", MANY);
    story_match("p-many");
    for (uint32_t i = 0; i < MANY; i++) {
        snprintf(box[i], sizeof box[i], "a%u", i);
        story_send("red", i + 1, box[i], "one");
        acks[i] = (muster_Ack){.box = box[i], .number = 1};
    }
    (void)story_collect();
    muster_Up up = {.process = words("p-many"),
                    .step = muster_STEP_NOW,
                    .broker_incarnation = story.b->incarnation};
    up.acks._buffer = acks;
    up.acks._length = up.acks._maximum = MANY;
    broker_up(story.b, &up, story.now_ns);
    story_send("red", MANY + 1, box[MANY - 1], "two");
    while (broker_next(story.b, &process, &d)) {
        mails += d.parcels._length;
        broker_delivered(story.b, story.now_ns);
    }
    CU_ASSERT_EQUAL(mails, 1);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"ten thousand agents", test_ten_thousand_agents},
        {"mail to ten thousand", test_mail_to_ten_thousand},
        {"an agent leaves its slot", test_an_agent_leaves_its_slot},
        {"a part is taken back", test_a_part_is_taken_back},
        {"who was lost is called", test_who_was_lost_is_called},
        {"who was missed and speaks is called", test_who_was_missed_and_speaks_is_called},
        {"bad names hurt nobody else", test_bad_names_hurt_nobody_else},
        {"limit: refusals", test_limit_refusals},
        {"limit: parts", test_limit_parts},
        {"a registration for another broker", test_a_registration_for_another_broker},
        {"agents that live elsewhere", test_agents_that_live_elsewhere},
        {"limits of a box are carried", test_limits_of_a_box_are_carried},
        {"a crowd is inherited", test_a_crowd_is_inherited},
        {"mail behind many that have none", test_mail_behind_many_that_have_none},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/crowd", tests);
}
