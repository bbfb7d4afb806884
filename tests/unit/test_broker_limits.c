/* SPDX-License-Identifier: Apache-2.0 */
#include "../support/broker_story.h"
#include "broker/parts.h"

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

static void test_limit_one_box(void)
{
    story_begin();
    story_join("red");
    story_join("green");
    story_state("green", muster_STATE_SUSPENDED);
    (void)story_collect();
    for (uint64_t i = 1; i <= MU_BOX_MAX; i++) {
        story_send("red", i, "green", "m");
    }
    EXPECT("red 1-32768 stored");
    story_send("red", MU_BOX_MAX + 1, "green", "one too many");
    EXPECT("red 32769-32769 box-full");
    CU_ASSERT_EQUAL(story_status().box_full, 1);
    story_send("red", MU_BOX_MAX + 2, "red", "other boxes have room");
    EXPECT("red #1 red/32770 other boxes have room");
    story_state("green", muster_STATE_RUNNING);
    (void)story_collect();
    story_ack("green", 1);
    (void)story_collect();
    story_send("red", MU_BOX_MAX + 3, "green", "room again");
    EXPECT("");
    CU_ASSERT_EQUAL(story_status().waiting, MU_BOX_MAX + 1);
}

static void test_limit_mails(void)
{
    crowd(3);
    for (uint64_t i = 1; i <= MU_MAILS_MAX; i++) {
        story_send("red", i, i % 2 ? "r0" : "r1", "m");
    }
    CU_ASSERT_EQUAL(story_status().waiting, MU_MAILS_MAX);
    CU_ASSERT_EQUAL(story_status().box_full, 0);
    story_send("red", MU_MAILS_MAX + 1, "r0,r2", "one too many");
    CU_ASSERT_EQUAL(story_status().box_full, 2);
    CU_ASSERT_EQUAL(story_status().sent, MU_MAILS_MAX + 2);
    story_send("red", MU_MAILS_MAX + 2, "r2", "one too many");
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "red 65537-65538 box-full"));
}

/* As many of the largest mails as fit, all let go, and the same number fits once more. */
static void test_limit_bytes_come_back(void)
{
    enum { FIT = 3 * (MU_MAIL_BYTES_MAX / (64 * 1024)) };
    memset(largest, 'x', MU_CONTENT_MAX);
    crowd(1);
    story_leave("r0", "p0");
    uint64_t seq = 0, full = 0;
    for (int round = 0; round < 3; round++) {
        for (int i = 0; i < FIT; i++) {
            muster_Mail m = letter("red", ++seq, "r0", round == 1 ? "small" : largest);
            m.ttl_ns = 1 * MS;
            story_mail(m);
        }
        CU_ASSERT_EQUAL(story_status().waiting, FIT);
        CU_ASSERT_EQUAL(story_status().box_full, full);
        if (round != 1) { /* small ones leave room */
            story_send("red", ++seq, "r0", largest);
            CU_ASSERT_EQUAL(story_status().box_full, ++full);
        }
        story_tick(1 * MS);
        CU_ASSERT_EQUAL(story_status().waiting, 0);
        CU_ASSERT_EQUAL(story.b->store.mails, 0);
        CU_ASSERT_EQUAL(story.b->mailbox.posts_live, 0);
    }
}

static void test_limit_posts(void)
{
    enum { AGENTS = 960, ROUNDS = MU_POSTS_MAX / AGENTS };
    crowd(AGENTS);
    for (uint64_t i = 1; i <= ROUNDS; i++) {
        story_send("red", i, "all", "m");
    }
    CU_ASSERT_EQUAL(story_status().box_full, 0);
    story_send("red", ROUNDS + 1, "all", "m");
    muster_BrokerStatus s = story_status();
    CU_ASSERT_EQUAL(s.waiting, MU_POSTS_MAX);
    CU_ASSERT_EQUAL(s.box_full, (ROUNDS + 1) * AGENTS - MU_POSTS_MAX);
    CU_ASSERT_EQUAL(s.sent, s.waiting + s.box_full);
}

static void test_limit_receipts_of_one_sender(void)
{
    static struct receipts kept; /* for leak checkers to see */
    struct receipts *r = &kept;
    receipts_init(r, 2);
    for (uint64_t i = 1; i <= RECEIPTS_EACH_MAX + 5; i++) {
        receipts_add(r, 1, 2 * i, muster_OUTCOME_DUPLICATE);
    }
    const struct receipt_queue *q = receipts_of(r, 1);
    CU_ASSERT_EQUAL(q->count, RECEIPTS_EACH_MAX);
    CU_ASSERT_EQUAL(r->pool[q->head].first_seq, 12); /* the five oldest are gone */
    CU_ASSERT_EQUAL(receipts_of(r, 0)->count, 0);
    receipts_drop(r, 1, q->count);
    receipts_add(r, 1, 7, muster_OUTCOME_STORED);
    receipts_add(r, 1, 8, muster_OUTCOME_STORED);
    receipts_add(r, 1, 9, muster_OUTCOME_DELIVERED);
    CU_ASSERT_EQUAL(q->count, 2);
    CU_ASSERT_EQUAL(r->pool[q->head].last_seq, 8);
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
        {"limit: places in boxes", test_limit_posts},
        {"limit: receipts of one sender", test_limit_receipts_of_one_sender},
        {"limit: bytes of one delivery", test_limit_bytes_of_one_delivery},
        CU_TEST_INFO_NULL,
    };
    return story_run("broker/limits", tests);
}
