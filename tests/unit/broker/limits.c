/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "broker_story.h"
#include "bus/check.h"

static char largest[MU_CONTENT_MAX + 1];

static void crowd(unsigned agents)
{
    char name[16], process[16];
    story_begin();
    story_join("red");
    for (unsigned i = 0; i < agents; i++) {
        snprintf(name, sizeof name, "r%u", i);
        snprintf(process, sizeof process, "p%u", i / MU_LOCAL_AGENTS_MAX);
        story_register(name, process);
        story_match(process);
    }
    (void)story_collect();
}

/* Takes all Deliveries, unread. */
static void collect(void)
{
    const char *process;
    muster_Delivery d;
    while (broker_next(story.b, &process, &d)) {
        broker_delivered(story.b, story.now_ns);
    }
}

/* Sends until the sender is told no.  @return how many mails went in */
static uint64_t send_until_full(const char *src, const char *const *dst, uint32_t dsts,
                                const char *content)
{
    static uint64_t seq;
    for (uint64_t sent = 0;; sent++) {
        muster_BrokerStatus before = story_status();
        muster_Mail m = letter(src, ++seq, dst[sent % dsts], content);
        story_up(src, muster_STEP_NOW, muster_STATE_RUNNING, &m, 1, 0);
        muster_BrokerStatus after = story_status();
        if (after.box_full + after.over_share > before.box_full + before.over_share) {
            return sent;
        }
    }
}

/* Lets one agent after the other send as much as it may.  @return how many mails went in */
static uint64_t crowd_send(uint32_t agents, const char *const *dst, uint32_t dsts,
                           const char *content)
{
    uint64_t sent = 0;
    for (uint32_t i = 0; i < agents; i++) {
        char name[16], process[16];
        snprintf(name, sizeof name, "s%u", i);
        snprintf(process, sizeof process, "p-s%u", i);
        story_register(name, process);
        sent += send_until_full(name, dst, dsts, content);
        story_gone(process);
    }
    return sent;
}

static void test_limit_one_box(void)
{
    static const char *const green[] = {"green"};
    story_begin();
    story_join("red");
    story_join("green");
    story_state("green", muster_STATE_SUSPENDED);
    (void)story_collect();
    for (uint64_t i = 1; i <= MU_BOX_MAX / 2; i++) {
        story_send("red", i, "green", "m");
    }
    EXPECT("red 1-16384 stored"); /* one sender alone: its share is one half */
    story_send("red", MU_BOX_MAX / 2 + 1, "green", "one too many");
    story_tick(100 * MS);
    EXPECT("red 16385-16385 box-full");
    CU_ASSERT_EQUAL(story_status().over_share, 1);
    CU_ASSERT_EQUAL(crowd_send(600, green, 1, "m"), MU_BOX_MAX / 2);
    CU_ASSERT_EQUAL(story_status().waiting, MU_BOX_MAX);
    story_send("green", 1, "green", "nothing there yet, and no room");
    EXPECT("green 1-1 box-full");
    story_send("red", MU_BOX_MAX + 2, "red", "other boxes have room");
    EXPECT("red #1 red/32770 other boxes have room");
    story_state("green", muster_STATE_RUNNING);
    (void)story_collect();
    story_ack("green", 1);
    (void)story_collect();
    story_send("green", 2, "green", "room again");
    EXPECT("");
    CU_ASSERT_EQUAL(story_status().waiting, MU_BOX_MAX + 1);
}

/* Ordinary mail leaves one place in 64 to directives. */
static void test_limit_mails(void)
{
    enum { ORDINARY = MU_MAILS_MAX - MU_MAILS_MAX / 64 };
    static const char *const boxes[] = {"r0", "r1", "r2", "r3"};
    crowd(4);
    story_join("operator");
    CU_ASSERT_EQUAL(crowd_send(1000, boxes, 4, "m"), ORDINARY);
    CU_ASSERT_EQUAL(story_status().waiting, ORDINARY);
    (void)story_collect();
    story_send("red", 1, "r0,r2", "one too many");
    EXPECT("red 1-1 box-full");
    for (uint64_t i = 1; i <= MU_MAILS_MAX / 64 + 1; i++) {
        muster_Mail m = letter("operator", i, i % 2 ? "r0,r1,operator" : "r2,r3", "(stop)");
        m.layer = 0;
        story_mail(m);
    }
    CU_ASSERT_EQUAL(story.b->pool.mails, MU_MAILS_MAX);
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "operator 1025-1025 box-full"));
}

/* As many of the largest mails as fit, all let go, and the same number fits once more. */
static void test_limit_bytes_come_back(void)
{
    static const char *const boxes[] = {"r0", "r1", "r2", "r3", "r4", "r5", "r6", "r7"};
    memset(largest, 'x', MU_CONTENT_MAX);
    crowd(8);
    uint64_t fit[3];
    for (int round = 0; round < 3; round++) {
        fit[round] = crowd_send(100, boxes, 8, round == 1 ? "small" : largest);
        uint64_t waiting = story_status().waiting;
        CU_ASSERT_EQUAL(waiting, fit[round]);
        for (uint32_t i = 0; i < 8; i++) {
            uint32_t agent = registry_find(&story.b->registry, boxes[i]);
            muster_Ack ack = {.box = words(boxes[i])};
            muster_Up up = {.process = words("p0"), .step = muster_STEP_NOW};
            up.acks = (dds_sequence_muster_Ack){._length = 1, ._buffer = &ack};
            do {
                collect();
                const struct box *box = mailbox_box(&story.b->mailbox, agent);
                ack.number = box->acked + box->lists[POST_FLIGHT].posts.count;
                story_hear(&up);
            } while (mailbox_box(&story.b->mailbox, agent)->use.mails > 0);
        }
        CU_ASSERT_EQUAL(story.b->pool.mails, 0);
        CU_ASSERT_EQUAL(story.b->mailbox.posts_pool.live, 0);
        CU_ASSERT_EQUAL(story.b->mailbox.quotas.pool.live, 0);
        CU_ASSERT_EQUAL(story.b->quotas.all[QUOTA_OUTSIDE].bytes, 0);
    }
    uint64_t most = (MU_MAIL_BYTES_MAX - MU_MAIL_BYTES_MAX / 64) / POOL_RECORD_MAX;
    CU_ASSERT_EQUAL(fit[0], most);
    CU_ASSERT_EQUAL(fit[2], most);
    CU_ASSERT_TRUE(fit[1] > 8 * most);
}

static void test_limit_acknowledgements(void)
{
    static muster_Ack acks[MU_LOCAL_AGENTS_MAX + 1];
    story_begin();
    story_register("red", "p1");
    for (uint32_t i = 0; i <= MU_LOCAL_AGENTS_MAX; i++) {
        acks[i].box = words("red");
    }
    muster_Up up = {.process = words("p1"), .step = muster_STEP_NOW};
    up.acks = (dds_sequence_muster_Ack){._length = MU_LOCAL_AGENTS_MAX, ._buffer = acks};
    CU_ASSERT_TRUE(check_up(&up));
    story_hear(&up);
    CU_ASSERT_EQUAL(story.b->counters.malformed, 0);
    up.acks._length++;
    CU_ASSERT_FALSE(check_up(&up));
}

static void test_limit_posts(void)
{
    enum { AGENTS = 700, ORDINARY = MU_POSTS_MAX - MU_POSTS_MAX / 64 };
    static const char *const all[] = {"all"};
    crowd(AGENTS);
    uint64_t lone = send_until_full("red", all, 1, "m");
    CU_ASSERT_EQUAL(lone, ORDINARY / 2 / AGENTS);
    CU_ASSERT_EQUAL(story_status().over_share, AGENTS);
    uint64_t sent = lone * AGENTS + crowd_send(300, all, 1, "m") * (AGENTS + 1);
    muster_BrokerStatus s = story_status();
    CU_ASSERT_EQUAL(s.waiting, sent);
    CU_ASSERT_TRUE(s.waiting <= ORDINARY && s.waiting > ORDINARY - AGENTS - 1);
    CU_ASSERT_EQUAL(s.sent, s.waiting + s.box_full + s.over_share);
    CU_ASSERT_EQUAL(story.b->quotas.all[QUOTA_OUTSIDE].posts, s.waiting);
}

static void test_limit_receipts_of_one_sender(void)
{
    static struct receipts kept;
    struct receipts *r = &kept;
    mu_pool_init(&r->pool, MU_MAILS_MAX);
    for (uint64_t i = 1; i <= RECEIPTS_EACH_MAX + 5; i++) {
        receipts_add(r, 1, 2 * i, 2 * i, muster_OUTCOME_DUPLICATE);
    }
    CU_ASSERT_EQUAL(receipts_count(r, 1), RECEIPTS_EACH_MAX);
    CU_ASSERT_EQUAL(r->at[mu_list_first(&r->queues[1])].first_seq,
                    12); /* the five oldest are gone */
    CU_ASSERT_EQUAL(r->lost, 5);
    CU_ASSERT_EQUAL(receipts_count(r, 0), 0);
    receipts_drop(r, 1, receipts_count(r, 1));
    receipts_add(r, 1, 7, 7, muster_OUTCOME_STORED);
    receipts_add(r, 1, 8, 8, muster_OUTCOME_STORED);
    receipts_add(r, 1, 9, 9, muster_OUTCOME_DELIVERED);
    CU_ASSERT_EQUAL(receipts_count(r, 1), 2);
    CU_ASSERT_EQUAL(r->at[mu_list_first(&r->queues[1])].last_seq, 8);
}

static void test_limit_receipts(void)
{
    static struct receipts kept;
    struct receipts *r = &kept;
    enum { AGENTS = MU_MAILS_MAX / RECEIPTS_EACH_MAX };
    mu_pool_init(&r->pool, MU_MAILS_MAX);
    for (uint32_t agent = 0; agent < AGENTS; agent++) {
        for (uint64_t i = 1; i <= RECEIPTS_EACH_MAX; i++) {
            receipts_add(r, agent, 2 * i, 2 * i, muster_OUTCOME_DUPLICATE);
        }
    }
    CU_ASSERT_EQUAL(r->lost, 0);
    receipts_add(r, AGENTS, 1, 1, muster_OUTCOME_STORED);
    CU_ASSERT_EQUAL(r->lost, 1);
    CU_ASSERT_EQUAL(receipts_count(r, AGENTS), 0);
    receipts_drop(r, 0, 1);
    receipts_add(r, AGENTS, 2, 2, muster_OUTCOME_STORED);
    CU_ASSERT_EQUAL(receipts_count(r, AGENTS), 1);
}

static void test_limit_bytes_of_one_delivery(void)
{
    const char *process;
    muster_Delivery d;
    memset(largest, 'x', MU_CONTENT_MAX);
    crowd(1);
    for (uint64_t i = 1; i <= 20; i++) {
        story_send("red", i, "r0", largest);
    }
    uint32_t parcels = 0, deliveries = 0;
    while (broker_next(story.b, &process, &d)) {
        CU_ASSERT_TRUE(d.parcels._length >= 1 && d.parcels._length < 8);
        for (uint32_t i = 0; i < d.parcels._length; i++) {
            CU_ASSERT_EQUAL(d.parcels._buffer[i].number, ++parcels);
        }
        deliveries++;
        broker_delivered(story.b, 0);
    }
    CU_ASSERT_EQUAL(parcels, 20);
    CU_ASSERT_EQUAL(deliveries, 3);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"limit: one box", test_limit_one_box},
        {"limit: mails", test_limit_mails},
        {"limit: bytes, which come back", test_limit_bytes_come_back},
        {"limit: acknowledgements in an Up", test_limit_acknowledgements},
        {"limit: places in boxes", test_limit_posts},
        {"limit: receipts of one sender", test_limit_receipts_of_one_sender},
        {"limit: receipts", test_limit_receipts},
        {"limit: bytes of one delivery", test_limit_bytes_of_one_delivery},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/limits", tests);
}
