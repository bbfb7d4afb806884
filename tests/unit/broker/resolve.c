/* SPDX-License-Identifier: Apache-2.0 */
/* Addresses that an agent resolves: who is asked, who waits, what an answer may be. */
#include "broker/mail/mail.h"
#include "broker/services/services.h"
#include "pages_story.h"

#define SECOND (1000 * MS)

static uint64_t seqs[128]; /* of each agent, by its slot */

static uint64_t next_seq(const char *src)
{
    return ++seqs[story_slot(src) % 128];
}

static muster_Mail from(const char *src, const char *dst, const char *content)
{
    return letter(src, next_seq(src), dst, content);
}

static void send_to(const char *src, const char *dst, const char *content)
{
    story_mail(from(src, dst, content));
}

static muster_Mail answer_of(const char *src, const char *performative, const char *ticket,
                             const char *content)
{
    muster_Mail m = from(src, "broker", content);
    m.layer = 2;
    m.performative = words(performative);
    m.in_reply_to = words(ticket);
    return m;
}

static void answer(const char *src, const char *ticket, const char *content)
{
    story_mail(answer_of(src, "inform", ticket, content));
}

static uint64_t counter(const char *name)
{
    muster_PartStatus s;
    CU_ASSERT_TRUE_FATAL(broker_part(story.b, PART_MAIL, &s));
    for (uint32_t i = 0; i < s.counters._length; i++) {
        if (strcmp(s.counters._buffer[i].name, name) == 0) {
            return s.counters._buffer[i].value;
        }
    }
    CU_FAIL_FATAL("no such counter");
    return 0;
}

/* The ticket of the first, second, ... question out of lock step. */
static const char *ticket_of(unsigned question)
{
    static char ticket[MU_FIELD_MAX + 1];
    uint64_t number = (1ull << 62) + question;
    snprintf(ticket, sizeof ticket, "resolve-%llu", (unsigned long long)number);
    return ticket;
}

static void offer(const char *name, const char *scheme)
{
    char content[64];
    snprintf(content, sizeof content, "resolver \"scheme=%s\"", scheme);
    muster_Mail m = from(name, "broker", content);
    m.layer = 2;
    m.performative = words("advertise");
    story_mail(m);
}

/* red, green and blue; rita and rob resolve near. */
static void team(void)
{
    memset(seqs, 0, sizeof seqs);
    story_begin();
    static const char *const names[] = {"red", "green", "blue", "rita", "rob"};
    for (unsigned i = 0; i < 5; i++) {
        story_join(names[i]);
    }
    offer("rob", "near");
    offer("rita", "near");
    (void)story_collect();
}

/* What is heard, without what the broker asks: "BOX SRC/SEQ CONTENT" and receipts. */
static const char *news(void)
{
    static char text[1 << 15];
    struct mu_text t;
    const char *from_, *to_;
    mu_text_init(&t, text, sizeof text);
    for (const char *line = story_collect(); *line; line = to_ + (to_[0] ? 2 : 0)) {
        from_ = line;
        to_ = strstr(line, "; ");
        to_ = to_ ? to_ : line + strlen(line);
        bool asked = memmem(from_, (size_t)(to_ - from_), " resolve \"", 10) != NULL;
        bool own = strncmp(from_, "rita ", 5) == 0 || strncmp(from_, "rob ", 4) == 0;
        if (!asked && !own) {
            mu_text_add(&t, t.len ? "; " : "");
            mu_text_add_bytes(&t, from_, (size_t)(to_ - from_));
        }
    }
    return text;
}

#define NEWS(wanted) HEARD(wanted, news())

static void test_the_resolver_fixes_the_receivers(void)
{
    team();
    send_to("red", "near:2.5", "hello");
    EXPECT("rita #1 broker/4611686018427387905 resolve \"near:2.5\" red");
    CU_ASSERT_EQUAL(counter("resolving"), 1);
    answer("rita", ticket_of(1), "green nobody red \"blue\" broker green 5 broker.delivery");
    EXPECT("green #1 red/1 hello; blue #1 red/1 hello; rita 2-2 delivered");
    CU_ASSERT_EQUAL(counter("resolving"), 0);
    story_ack("blue", 1);
    EXPECT("");
    story_ack("green", 1);
    EXPECT("red 1-1 delivered");
    CU_ASSERT_EQUAL(story_status().stored, 1); /* the question, until rita acknowledges it */
}

static void test_who_is_asked(void)
{
    team();
    send_to("red", "role:scout", "hello");
    EXPECT("red 1-1 unknown-name");
    story_gone("p-rita");
    send_to("red", "near:1", "hello");
    EXPECT("rob #1 broker/4611686018427387905 resolve \"near:1\" red");
    story_register("rita", "p-rita");
    (void)story_collect();
    send_to("red", "near:2", "hello");
    EXPECT("rita #1 broker/4611686018427387906 resolve \"near:2\" red");
    answer("rita", ticket_of(2), "blue"); /* waits for the answer to the first */
    NEWS("");
    answer("rob", ticket_of(1), "green");
    NEWS("green #1 red/2 hello; blue #1 red/3 hello");
    muster_Mail m = from("rita", "broker", "resolver");
    m.layer = 2;
    m.performative = words("withdraw");
    story_mail(m);
    story_gone("p-rob");
    send_to("red", "near:3", "hello");
    NEWS("red 4-4 unknown-name");
}

static void test_nobody_is_an_answer(void)
{
    team();
    send_to("red", "near:0.1", "hello");
    answer("rita", ticket_of(1), "");
    NEWS("red 1-1 unknown-name");
    send_to("red", "near:0.1", "hello");
    answer("rita", ticket_of(2), "nobody");
    NEWS("red 2-2 unknown-name");
    send_to("red", "near:x", "hello");
    story_mail(answer_of("rita", "failure", ticket_of(3), "no-such-address"));
    NEWS("red 3-3 unknown-name");
    CU_ASSERT_EQUAL(story_status().unknown_name, 3);
}

static void test_mail_that_follows_waits(void)
{
    team();
    send_to("red", "green", "one");
    send_to("red", "near:1", "two");
    send_to("red", "green", "three");
    send_to("red", "near:2", "four");
    send_to("red", "green,blue", "five");
    send_to("blue", "green", "of another");
    NEWS("green #1 red/1 one; green #2 blue/1 of another");
    CU_ASSERT_EQUAL(counter("resolving"), 4);
    /* The broker answers at once. */
    muster_Mail m = from("red", "broker", "north");
    m.layer = 2;
    m.performative = words("members");
    story_mail(m);
    NEWS("red #1 broker/4611686018427387907 unknown-group north; red 6-6 delivered");
    answer("rita", ticket_of(2), "green");
    NEWS("");
    answer("rita", ticket_of(1), "green");
    NEWS("green #3 red/2 two; green #4 red/3 three; green #5 red/4 four; green #6 red/5 five; "
         "blue #1 red/5 five");
}

static void test_no_answer_in_time(void)
{
    team();
    send_to("red", "near:1", "one");
    send_to("red", "green", "two");
    story_tick(SECOND / 2);
    send_to("blue", "near:1", "three");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), SECOND);
    story_gone("p-rita"); /* it is dead: nobody else is asked */
    (void)story_collect();
    story_tick(SECOND / 2 - 1);
    NEWS("");
    story_tick(1);
    NEWS("red 1-1 unknown-name; green #1 red/2 two");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), 3 * SECOND / 2);
    story_register("rita", "p-rita");
    (void)story_collect();
    answer("rita", ticket_of(1), "green"); /* too late */
    NEWS("");
    CU_ASSERT_EQUAL(counter("resolve-refused"), 1);
    answer("rita", ticket_of(2), "green"); /* in time, after all */
    NEWS("green #2 blue/1 three");
    CU_ASSERT_EQUAL(counter("resolving"), 0);
}

static void test_answers_of_others_are_refused(void)
{
    team();
    send_to("red", "near:1", "hello");
    static const char *const tickets[] = {"resolve-", "resolve-1", "resolve--1", "resolve-9x",
                                          "resolve-99999999999999999999999"};
    for (size_t i = 0; i < sizeof tickets / sizeof tickets[0]; i++) {
        answer("rita", tickets[i], "green");
    }
    answer("rob", ticket_of(1), "green");
    answer("red", ticket_of(1), "green");
    muster_Mail m = answer_of("rita", "inform", ticket_of(1), "green");
    m.dst = words("broker,blue"); /* who answers in a list is not heard */
    story_mail(m);
    NEWS("red 2-2 delivered; blue #1 rita/7 green");
    CU_ASSERT_EQUAL(counter("resolve-refused"), 8);
    answer("rita", ticket_of(1), "blue");
    NEWS("blue #2 red/1 hello");
    answer("rita", ticket_of(1), "green"); /* once is enough */
    NEWS("");
    CU_ASSERT_EQUAL(counter("resolve-refused"), 9);
}

static void test_garbage_in_answers(void)
{
    static const char *const contents[] = {"(green)", "\"green", "green )",
                                           "\"a string longer than any name of an agent can be",
                                           "green \""};
    for (size_t i = 0; i < sizeof contents / sizeof contents[0]; i++) {
        team();
        send_to("red", "near:1", "hello");
        answer("rita", ticket_of(1), contents[i]);
        NEWS("red 1-1 unknown-name");
        CU_ASSERT_EQUAL(counter("malformed"), 1);
    }
    team();
    send_to("red", "near:1", "hello");
    answer("rita", ticket_of(1),
           "a-symbol-longer-than-any-name-of-an-agent green \"another string that is as long as "
           "that\" 1e400 :x blue");
    NEWS("green #1 red/1 hello; blue #1 red/1 hello");
    send_to("red", "near:1", "hello");
    story_mail(answer_of("rita", "tell", ticket_of(2), "green")); /* neither yes nor no */
    NEWS("red 2-2 unknown-name");
}

static void test_lists_have_no_addresses(void)
{
    team();
    send_to("red", "green,near:1", "hello");
    send_to("red", "near:1 2", "hello");
    send_to("red", "near:", "hello");
    NEWS("red 1-3 refused");
    send_to("red", "near:1,green", "hello"); /* the rest is the resolver's to read */
    EXPECT("rita #1 broker/4611686018427387905 resolve \"near:1,green\" red");
    send_to("red", "near:\"\\", "hello");
    EXPECT("rita #2 broker/4611686018427387906 resolve \"near:\\\"\\\\\" red");
}

static void test_a_sender_waits_with_so_many(void)
{
    team();
    send_to("red", "near:1", "first");
    for (unsigned i = 1; i < MU_RESOLVE_SENDER_MAX; i++) {
        send_to("red", "green", "m");
    }
    NEWS("");
    send_to("red", "green", "too many");
    send_to("red", "near:1", "too many");
    NEWS("red 65-66 box-full");
    answer("rita", ticket_of(1), "blue");
    (void)news();
    CU_ASSERT_EQUAL(story_status().waiting, MU_RESOLVE_SENDER_MAX + 1); /* and the question */
    send_to("red", "blue", "now");
    NEWS("blue #2 red/67 now");
}

static void test_all_senders_wait_with_so_many(void)
{
    team();
    enum { SENDERS = MU_RESOLVE_MAX / MU_RESOLVE_SENDER_MAX };
    char name[16];
    for (unsigned i = 0; i < SENDERS; i++) {
        snprintf(name, sizeof name, "a%u", i);
        story_join(name);
        send_to(name, "near:1", "m");
        for (unsigned k = 1; k < MU_RESOLVE_SENDER_MAX; k++) {
            send_to(name, "green", "m");
        }
    }
    NEWS("");
    CU_ASSERT_EQUAL(counter("resolving"), MU_RESOLVE_MAX);
    send_to("red", "near:1", "one more");
    NEWS("red 1-1 box-full");
    send_to("red", "blue", "who does not wait needs no room");
    NEWS("blue #1 red/2 who does not wait needs no room");
    answer("rita", ticket_of(1), "");
    (void)news();
    send_to("red", "near:1", "now");
    answer("rita", ticket_of(SENDERS + 1), "blue");
    NEWS("blue #2 red/3 now");
}

static void test_directives_are_judged_when_it_is_known_for_whom(void)
{
    team();
    story_join("operator");
    muster_Mail m = from("red", "near:1", "(stop)");
    m.layer = 0;
    m.performative = words("do");
    story_mail(m);
    NEWS("");
    answer("rita", ticket_of(1), "green blue");
    NEWS("red 1-1 refused");
    m.src = words("operator");
    story_mail(m);
    answer("rita", ticket_of(2), "green blue");
    NEWS("green #1 operator/1 (stop); blue #1 operator/1 (stop)");
}

static void test_waiting_takes_of_the_time_to_live(void)
{
    team();
    story_state("green", muster_STATE_SUSPENDED);
    (void)story_collect();
    muster_Mail m = from("red", "near:1", "fresh");
    m.ttl_ns = 300 * MS;
    story_mail(m);
    story_tick(200 * MS);
    answer("rita", ticket_of(1), "green");
    NEWS("red 1-1 stored");
    story_tick(100 * MS - 1);
    NEWS("");
    story_tick(1);
    NEWS("red 1-1 expired");
    m.seq = next_seq("red");
    story_mail(m);
    story_tick(400 * MS);
    answer("rita", ticket_of(2), "green");
    story_tick(1);
    NEWS("red 2-2 stored; red 2-2 expired");
}

/* --- in lock step ----------------------------------------------------------------------------- */

/* red and rita are in the lock step, and step 0 begins. */
static void lockstep_begin(void)
{
    team();
    story_match("sim");
    pages_roster(true, 0, "p-red", "p-rita");
    (void)story_collect();
}

static void step_silently(int64_t step)
{
    answer_step("red", step, NULL);
    answer_step("rita", step, NULL);
}

static void test_a_step_for_the_question_and_one_for_the_mail(void)
{
    lockstep_begin();
    muster_Mail m = from("red", "near:2", "hello");
    answer_step("red", 0, &m);
    EXPECT("");
    answer_step("rita", 0, NULL);
    EXPECT("p-rita@0; rita #1 broker/1 resolve \"near:2\" red; p-red@0; sim@0");
    muster_Mail own = from("red", "rita", "follows");
    answer_step("red", 1, &own);
    muster_Mail a = answer_of("rita", "inform", "resolve-1", "rita red green");
    answer_step("rita", 1, &a);
    EXPECT("p-rita@1; rita #2 red/1 hello; rita #3 red/2 follows; rita 2-2 delivered; green #1 "
           "red/1 hello; p-red@1; "
           "red 1-1 stored; sim@1");
}

static void test_patience_in_steps(void)
{
    lockstep_begin();
    muster_Mail m = from("red", "near:2", "hello");
    answer_step("red", 0, &m);
    answer_step("rita", 0, NULL);
    (void)story_collect();
    story_tick(60 * SECOND); /* the wall does not count */
    for (int64_t step = 1; step < RESOLVE_PATIENCE_STEPS; step++) {
        step_silently(step);
    }
    CU_ASSERT_EQUAL(counter("resolving"), 1);
    step_silently(RESOLVE_PATIENCE_STEPS);
    CU_ASSERT_EQUAL(counter("resolving"), 0);
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "red 1-1 unknown-name"));
    muster_Mail again = from("red", "near:2", "hello");
    answer_step("red", 11, &again);
    answer_step("rita", 11, NULL);
    for (int64_t step = 12; step < 11 + RESOLVE_PATIENCE_STEPS; step++) {
        step_silently(step);
    }
    muster_Mail a = answer_of("rita", "inform", "resolve-2", "rita");
    answer_step("rita", 21, &a); /* in the last step that counts */
    answer_step("red", 21, NULL);
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "red/2 hello"));
}

static void test_who_is_outside_is_not_asked(void)
{
    team();
    pages_roster(true, 0, "p-red", NULL);
    (void)story_collect();
    muster_Mail m = from("red", "near:2", "hello");
    answer_step("red", 0, &m);
    EXPECT("p-red@0; red 1-1 unknown-name");
    send_to("blue", "near:2", "hello");
    NEWS("blue 1-1 unknown-name");
}

static void test_mail_from_outside_takes_effect_when_a_step_ends(void)
{
    lockstep_begin();
    send_to("blue", "near:2", "one");
    send_to("blue", "green", "two"); /* not before the first one */
    send_to("green", "blue", "of another");
    EXPECT("blue #1 green/1 of another");
    step_silently(0);
    EXPECT("p-rita@0; rita #1 broker/1 resolve \"near:2\" blue; p-red@0; sim@0; outside blue/1; "
           "outside blue/2");
    send_to("blue", "green", "three");
    EXPECT("");
    answer_step("red", 1, NULL);
    muster_Mail a = answer_of("rita", "inform", "resolve-1", "green red");
    answer_step("rita", 1, &a);
    EXPECT("green #1 blue/1 one; green #2 blue/2 two; green #3 blue/3 three; p-red@1; red #1 "
           "blue/1 one; "
           "p-rita@1; rita 2-2 delivered; sim@1");
}

static void test_a_lock_step_begins_without_what_was_asked_before(void)
{
    team();
    send_to("red", "near:2", "hello");
    send_to("blue", "near:2", "hello");
    (void)news();
    pages_roster(true, 0, "p-red", "p-rita");
    CU_ASSERT_EQUAL(counter("resolving"), 0);
    const char *got = story_collect();
    CU_ASSERT_PTR_NOT_NULL(strstr(got, "red 1-1 unknown-name"));
    CU_ASSERT_PTR_NOT_NULL(strstr(got, "blue 1-1 unknown-name"));
    muster_Mail a = answer_of("rita", "inform", ticket_of(1), "red");
    answer_step("rita", 0, &a);
    answer_step("red", 0, NULL);
    CU_ASSERT_EQUAL(counter("resolve-refused"), 1);
}

/* What an ended lock step has left is answered all the same. */
static void test_a_lock_step_ends(void)
{
    lockstep_begin();
    muster_Mail m = from("red", "near:2", "hello");
    answer_step("red", 0, &m);
    answer_step("rita", 0, NULL);
    (void)story_collect();
    pages_roster(false, 1, "p-red", NULL);
    (void)story_collect();
    answer("rita", "resolve-1", "green");
    NEWS("green #1 red/1 hello");
    CU_ASSERT_EQUAL(counter("resolving"), 0);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the resolver fixes the receivers", test_the_resolver_fixes_the_receivers},
        {"who is asked", test_who_is_asked},
        {"nobody is an answer", test_nobody_is_an_answer},
        {"mail that follows waits", test_mail_that_follows_waits},
        {"no answer in time", test_no_answer_in_time},
        {"answers of others are refused", test_answers_of_others_are_refused},
        {"garbage in answers", test_garbage_in_answers},
        {"lists have no addresses", test_lists_have_no_addresses},
        {"a sender waits with so many", test_a_sender_waits_with_so_many},
        {"all senders wait with so many", test_all_senders_wait_with_so_many},
        {"directives are judged when it is known for whom",
         test_directives_are_judged_when_it_is_known_for_whom},
        {"waiting takes of the time to live", test_waiting_takes_of_the_time_to_live},
        {"a step for the question, and one for the mail",
         test_a_step_for_the_question_and_one_for_the_mail},
        {"patience in steps", test_patience_in_steps},
        {"who is outside is not asked", test_who_is_outside_is_not_asked},
        {"mail from outside takes effect when a step ends",
         test_mail_from_outside_takes_effect_when_a_step_ends},
        {"a lock step begins without what was asked before",
         test_a_lock_step_begins_without_what_was_asked_before},
        {"a lock step ends", test_a_lock_step_ends},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker: resolve", tests);
}
