/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Random lives of six agents against a simple model of what mail promises: nothing is lost,
 * nothing is handed out under two numbers, each sender's mails come in order, the suspended get
 * nothing new, and the counters add up.
 */
#include "broker_story.h"
#include "core/random.h"

enum { AGENTS = 6, OPS = 6000, MAILS_MAX = OPS + 1, SEEDS = 12 };

static const char *const names[AGENTS] = {"a", "b", "c", "d", "e", "f"};

struct model_agent {
    bool there, suspended;
    uint32_t lives; /* gives each process its own name */
    char process[16];
    uint64_t seq;
    uint32_t mail_of_number[MAILS_MAX]; /* the box's numbers, from 1 */
    uint64_t numbers;                   /* handed out, each at least once */
    uint64_t seen;                      /* the last number that this life has had */
    uint64_t acked;
    uint64_t last_seq_from[AGENTS][3]; /* of each priority */
    bool expected[MAILS_MAX];          /* to come, once */
    uint32_t expected_count;
};

static struct model_agent agents[AGENTS];
static uint32_t mails;  /* sent so far; a mail's content is its number */
static uint64_t copies; /* counted per receiver */
static uint64_t repeats;
static struct mu_random dice;

static uint32_t roll(uint32_t sides)
{
    return (uint32_t)mu_random_between(&dice, 0, sides - 1);
}

/* --- what is handed out ----------------------------------------------------------------------- */

static void check_parcel(const muster_Parcel *p, const char *process)
{
    uint32_t to = (uint32_t)(p->box[0] - 'a'), from = (uint32_t)(p->letter.src[0] - 'a');
    struct model_agent *a = &agents[to];
    uint32_t mail = (uint32_t)strtoul(p->letter.content, NULL, 10);
    uint64_t *last_seq = &a->last_seq_from[from][p->letter.priority + 1];
    CU_ASSERT_TRUE_FATAL(a->there && strcmp(process, a->process) == 0);
    if (p->number <= a->numbers) { /* again: as it was */
        CU_ASSERT_EQUAL_FATAL(a->mail_of_number[p->number], mail);
        CU_ASSERT_TRUE_FATAL(p->number > a->acked);
        repeats++;
    } else {
        CU_ASSERT_EQUAL_FATAL(p->number, a->numbers + 1);
        CU_ASSERT_TRUE_FATAL(a->expected[mail] && !a->suspended);
        CU_ASSERT_TRUE_FATAL(p->letter.seq > *last_seq);
        a->expected[mail] = false;
        a->expected_count--;
        *last_seq = p->letter.seq;
        a->mail_of_number[++a->numbers] = mail;
    }
    /* A life that has had a number has had all before, or they were acknowledged earlier. */
    CU_ASSERT_TRUE_FATAL(p->number <= a->seen + 1 || (a->seen == 0 && p->number == a->acked + 1));
    a->seen = p->number > a->seen ? p->number : a->seen;
}

static void take_deliveries(void)
{
    const char *process;
    muster_Delivery d;
    while (broker_next(story.b, &process, &d)) {
        if (roll(8) == 0) {
            broker_undelivered(story.b);
            continue;
        }
        for (uint32_t i = 0; i < d.parcels._length; i++) {
            check_parcel(&d.parcels._buffer[i], process);
        }
        broker_delivered(story.b, story.now_ns);
    }
    muster_BrokerStatus s = story_status();
    CU_ASSERT_EQUAL_FATAL(s.sent, copies);
    CU_ASSERT_EQUAL_FATAL(s.sent, s.delivered + s.waiting);
    CU_ASSERT_EQUAL_FATAL(s.malformed + s.box_full + s.expired + s.refused + s.unknown_name, 0);
    CU_ASSERT_EQUAL_FATAL(s.resent, repeats);
}

/* --- what agents do --------------------------------------------------------------------------- */

static void say(uint32_t agent, muster_Mail *mail, uint64_t ack)
{
    struct model_agent *a = &agents[agent];
    muster_Act act = {.agent = words(names[agent]), .rules = words("")};
    act.mails = (dds_sequence_muster_Mail){._length = mail != NULL, ._buffer = mail};
    muster_Ack taken = {.box = words(names[agent]), .number = ack};
    muster_Up up = {.process = a->process, .step = muster_STEP_NOW};
    up.acts = (dds_sequence_muster_Act){._length = 1, ._buffer = &act};
    up.acks = (dds_sequence_muster_Ack){._length = ack > 0, ._buffer = &taken};
    story_hear(&up);
}

static void op_register(uint32_t agent)
{
    struct model_agent *a = &agents[agent];
    if (!a->there) {
        a->there = true;
        a->suspended = false;
        a->seen = 0;
        snprintf(a->process, sizeof a->process, "p%u-%s", ++a->lives, names[agent]);
    }
    muster_Registration r = registration(names[agent], a->process);
    entry_of(&r)->state = a->suspended ? muster_STATE_SUSPENDED : muster_STATE_RUNNING;
    broker_registration(story.b, &r, story.now_ns);
    broker_matched(story.b, a->process, true, story.now_ns);
}

static void op_suspend(uint32_t agent)
{
    if (agents[agent].there) {
        agents[agent].suspended = !agents[agent].suspended;
        op_register(agent);
    }
}

static void op_crash(uint32_t agent)
{
    struct model_agent *a = &agents[agent];
    if (a->there) {
        a->there = false;
        broker_gone(story.b, a->process, 0, true, story.now_ns);
        broker_matched(story.b, a->process, false, story.now_ns);
    }
}

static void op_send(uint32_t agent)
{
    static const char *const dst[] = {"a", "b", "c", "d", "e", "f", "all", "a,c,f"};
    if (!agents[agent].there) {
        return;
    }
    char content[16];
    uint32_t to = roll(8);
    muster_Mail m = letter(names[agent], ++agents[agent].seq, dst[to], content);
    m.priority = (int32_t)roll(3) - 1;
    snprintf(content, sizeof content, "%u", ++mails);
    for (uint32_t i = 0; i < AGENTS; i++) {
        struct model_agent *r = &agents[i];
        bool meant = to == 6 ? r->there && i != agent : strchr(dst[to], names[i][0]) != NULL;
        r->expected[mails] = meant;
        r->expected_count += meant;
        copies += meant;
    }
    say(agent, &m, 0);
    if (roll(10) == 0) {
        say(agent, &m, 0); /* the sender is not sure, and says it again */
    }
}

static void op_acknowledge(uint32_t agent)
{
    struct model_agent *a = &agents[agent];
    if (a->there && a->seen > a->acked) {
        a->acked += 1 + roll((uint32_t)(a->seen - a->acked));
        say(agent, NULL, a->acked);
    }
}

static void op_tick(uint32_t agent)
{
    (void)agent;
    story_tick(roll(400) * MS);
}

static void live(uint64_t seed)
{
    static void (*const ops[])(uint32_t agent) = {
        op_send,        op_send,        op_send,     op_send,    op_acknowledge,
        op_acknowledge, op_acknowledge, op_register, op_suspend, op_tick,
    };
    story_begin();
    memset(agents, 0, sizeof agents);
    mails = 0;
    copies = repeats = 0;
    mu_random_seed(&dice, seed, "model");
    for (uint32_t i = 0; i < AGENTS; i++) {
        op_register(i); /* from now on, all names are known */
    }
    for (int i = 0; i < OPS; i++) {
        uint32_t agent = roll(AGENTS);
        (roll(40) == 0 ? op_crash : ops[roll(10)])(agent);
        if (roll(3) > 0) {
            take_deliveries();
        }
    }
}

/* Everybody comes back and takes all. */
static void live_out(void)
{
    for (int round = 0; round < 10000 && story_status().waiting > 0; round++) {
        for (uint32_t i = 0; i < AGENTS; i++) {
            agents[i].suspended = false;
            op_register(i);
        }
        story_tick(10 * MS);
        take_deliveries();
        for (uint32_t i = 0; i < AGENTS; i++) {
            op_acknowledge(i);
        }
    }
}

static void test_random_lives(void)
{
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        live(seed);
        CU_ASSERT_TRUE(mails > 500 && repeats > 20);
        CU_ASSERT_TRUE(story_status().duplicates_dropped > 10);
        live_out();
        CU_ASSERT_EQUAL(story_status().waiting, 0);
        CU_ASSERT_EQUAL(story_status().delivered, copies);
        for (uint32_t i = 0; i < AGENTS; i++) {
            CU_ASSERT_EQUAL(agents[i].expected_count, 0);
            CU_ASSERT_EQUAL(agents[i].acked, agents[i].numbers);
        }
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"random lives", test_random_lives},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/model", tests);
}
