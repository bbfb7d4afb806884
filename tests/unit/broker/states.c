/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/mail/mail.h"
#include "broker/names/names.h"
#include "state_walk.h"
#include "suite.h"

#include <CUnit/Basic.h>

static int apply_told(int state, int event)
{
    struct mail m = {.told = (enum mail_told)state};
    bool is_news = mail_tell(&m, (enum mail_told)(event + 1));
    CU_ASSERT_EQUAL(is_news, m.told != (enum mail_told)state);
    return (int)m.told;
}

static int apply_fate(int state, int event)
{
    struct mail m = {.fate = (enum mail_fate)state};
    mail_meets(&m, (enum mail_fate)(event + 1));
    return (int)m.fate;
}

static int apply_durable(int state, int event)
{
    struct mail m = {.durable = (enum mail_durable)state};
    bool changes = mail_durable_on(&m, (enum mail_durable_event)event);
    CU_ASSERT_EQUAL(changes, m.durable != (enum mail_durable)state);
    CU_ASSERT_EQUAL(mail_is_written(&m),
                    m.durable == DURABLE_WRITTEN || m.durable == DURABLE_MARKED_AGAIN);
    return (int)m.durable;
}

static int apply_peer(int state, int event)
{
    static struct federation l;
    static struct peer p;
    l.peers_there = 5;
    l.count.earlier_lives = 0;
    p.state = (enum peer_state)state;
    bool allowed = remote_peer_on(&l, &p, (enum peer_event)event);
    CU_ASSERT_EQUAL(l.count.earlier_lives, !allowed);
    CU_ASSERT(allowed || p.state == (enum peer_state)state);
    CU_ASSERT_EQUAL(l.peers_there + (state == PEER_THERE), 5u + (p.state == PEER_THERE));
    return allowed ? (int)p.state : -1;
}

static void test_what_a_sender_was_told(void)
{
    static const char *const rows[TOLD_STATES] = {"|SL", "|SL", "|LL"};
    state_walk(apply_told, "NSL", rows);
}

static void test_the_worst_counts(void)
{
    static const char *const rows[FATES] = {"|PED", "|PED", "|EED", "|DDD"};
    static const muster_Outcome outcomes[FATES] = {muster_OUTCOME_DELIVERED, muster_OUTCOME_STORED,
                                                   muster_OUTCOME_EXPIRED, muster_OUTCOME_DROPPED};
    state_walk(apply_fate, "TPED", rows);
    for (int fate = 0; fate < FATES; fate++) {
        struct mail m = {.fate = (enum mail_fate)fate};
        CU_ASSERT_EQUAL(mail_outcome(&m), outcomes[fate]);
    }
}

static void test_a_mail_on_disk(void)
{
    static const char *const rows[DURABLE_STATES] = {"|M.W.", "|MW.N", "|A...", "|AW.."};
    CU_ASSERT_EQUAL(DURABLE_EVENTS, 4);
    state_walk(apply_durable, "NMWA", rows);
}

static void test_another_broker(void)
{
    static const char *const rows[PEER_STATES] = {".|.S...", ".|SSTSU", ".|TTTS."};
    CU_ASSERT(PEER_OWN_EVENTS == 1 && PEER_EVENTS == 6);
    state_walk(apply_peer, "UST", rows);
}

int main(void)
{
    CU_TestInfo tests[] = {{"what a sender was told of a mail", test_what_a_sender_was_told},
                           {"the worst that became of a mail counts", test_the_worst_counts},
                           {"a mail on disk", test_a_mail_on_disk},
                           {"another broker", test_another_broker},
                           CU_TEST_INFO_NULL};
    return suite_run("broker/states", tests);
}
