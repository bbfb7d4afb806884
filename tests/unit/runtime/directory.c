/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A process's copy of groups and yellow pages, without a network: changes come in as deliveries,
 * and what agents send lies in their outboxes.
 */
#include "capture.h"
#include "core/random.h"
#include "core/text.h"
#include "runtime/process.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static mu_process process;
static struct directory kept[16]; /* leak checkers see their memory */
static unsigned kept_count;
static char heard_buffer[4096];
static struct mu_text heard;
static mu_agent *red;

static void on_service(void *self, mu_agent *a, const struct mu_service *service, bool came)
{
    (void)self;
    mu_text_format(&heard, "%s: %c%s@%s[%s]; ", mu_agent_name(a), came ? '+' : '-',
                   service->service, service->agent, service->attributes);
}

static void on_refusal(void *self, mu_agent *a, const char *change, const char *reason)
{
    (void)self;
    mu_text_format(&heard, "%s: no %s: %s; ", mu_agent_name(a), change, reason);
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    mu_text_format(&heard, "%s: %s %s; ", mu_agent_name(a), mail->src, mail->content);
}

static mu_agent *join(const char *name, bool hears_refusals)
{
    mu_agent *a = NULL;
    struct mu_handlers handlers = {.on_mail = on_mail,
                                   .on_service = on_service,
                                   .on_refusal = hears_refusals ? on_refusal : NULL};
    capture_begin(); /* registering finds no network, and says so */
    CU_ASSERT_EQUAL(mu_agent_join(&process, &a, name, MU_KIND_AGENT, 0, &handlers), MU_OK);
    capture_end();
    CU_ASSERT_PTR_NOT_NULL_FATAL(a);
    return a;
}

static void set_up(void)
{
    memset(&process, 0, sizeof process);
    process_take_memory(&process, 2, 64);
    directory_init(&process.directory);
    kept[kept_count++ % 16] = process.directory;
    mu_text_init(&heard, heard_buffer, sizeof heard_buffer);
    red = join("red", true);
}

#define HEARD(wanted)                             \
    do {                                          \
        CU_ASSERT_STRING_EQUAL(heard.at, wanted); \
        mu_text_clear(&heard);                    \
    } while (0)

/* --- what the broker says --------------------------------------------------------------------- */

static void member(const char *group, const char *agent, bool joined)
{
    muster_Membership m = {
        .group = words(group), .agent = words(agent), .joined = joined, .origin = words("b")};
    muster_Delivery d = {.process = words("p1"), .step = muster_STEP_NOW};
    d.memberships._buffer = &m;
    d.memberships._length = 1;
    step_take_delivery(&process, &d, NULL);
}

static void offer(const char *service, const char *agent, const char *attributes)
{
    muster_Offer o = {.service = words(service),
                      .agent = words(agent),
                      .offered = attributes != NULL,
                      .attributes = words(attributes ? attributes : ""),
                      .origin = words("b")};
    muster_Delivery d = {.process = words("p1"), .step = muster_STEP_NOW};
    d.offers._buffer = &o;
    d.offers._length = 1;
    step_take_delivery(&process, &d, NULL);
}

static void verdict(uint64_t incarnation)
{
    muster_Verdict v = {.agent = words("red"),
                        .accepted = true,
                        .broker_incarnation = incarnation,
                        .reason = words("")};
    muster_Delivery d = {.process = words("p1"), .step = muster_STEP_NOW};
    d.verdicts._buffer = &v;
    d.verdicts._length = 1;
    step_take_delivery(&process, &d, NULL);
}

static void answer(const char *src, const char *performative, const char *in_reply_to,
                   const char *content)
{
    static uint64_t number;
    number = red->last_number + 1;
    red->name_state = NAME_ACCEPTED;
    muster_Parcel p = {.box = words("red"),
                       .number = number,
                       .letter = {.src = words(src),
                                  .seq = number,
                                  .dst = words("red"),
                                  .layer = MU_LAYER_QUERY,
                                  .performative = words(performative),
                                  .language = words(""),
                                  .ontology = words(""),
                                  .reply_with = words(""),
                                  .in_reply_to = words(in_reply_to),
                                  .conversation = words(""),
                                  .content = words(content)}};
    muster_Delivery d = {.process = words("p1"), .step = muster_STEP_NOW};
    d.parcels._buffer = &p;
    d.parcels._length = 1;
    step_take_delivery(&process, &d, NULL);
}

/* --- tests ------------------------------------------------------------------------------------ */

static void group_list(char *text, size_t size, const char *group)
{
    struct mu_text t;
    const char *name;
    mu_text_init(&t, text, size);
    for (size_t i = 0; (name = group ? mu_process_group_member(&process, group, i)
                                     : mu_process_group(&process, i));
         i++) {
        mu_text_format(&t, " %s", name);
    }
}

static void test_groups(void)
{
    char text[256];
    member("scouts", "", true);
    member("cooks", "red", true); /* a group is there with its members alone, too */
    member("scouts", "red", true);
    member("scouts", "blue", true);
    member("scouts", "blue", true);
    group_list(text, sizeof text, NULL);
    CU_ASSERT_STRING_EQUAL(text, " cooks scouts");
    group_list(text, sizeof text, "scouts");
    CU_ASSERT_STRING_EQUAL(text, " blue red");
    CU_ASSERT_TRUE(mu_process_in_group(&process, "cooks", "red"));
    CU_ASSERT_FALSE(mu_process_in_group(&process, "cooks", "blue"));
    CU_ASSERT_FALSE(mu_process_in_group(&process, "miners", "red"));
    member("scouts", "", false);
    member("scouts", "red", false);
    group_list(text, sizeof text, NULL);
    CU_ASSERT_STRING_EQUAL(text, " cooks scouts");
    member("scouts", "blue", false);
    member("miners", "blue", false);
    group_list(text, sizeof text, NULL);
    CU_ASSERT_STRING_EQUAL(text, " cooks");
    CU_ASSERT_PTR_NULL(mu_process_group_member(&process, "scouts", 0));
    CU_ASSERT_PTR_NULL(mu_process_group_member(&process, "", 0));
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    CU_ASSERT_PTR_NULL(mu_process_group_member(&process, text, 0));
    CU_ASSERT_FALSE(mu_process_in_group(&process, text, text));
    CU_ASSERT_FALSE(mu_process_in_group(&process, NULL, "red"));
}

static const char *found(const char *query, size_t index)
{
    static char line[512];
    const struct mu_service *s = mu_process_find_service(&process, query, index);
    snprintf(line, sizeof line, "nobody");
    if (s) {
        snprintf(line, sizeof line, "%s@%s", s->service, s->agent);
    }
    return line;
}

static void test_finding(void)
{
    offer("mapper", "red", "x=1");
    offer("mapper", "blue", "x=2");
    offer("cook", "red", "");
    CU_ASSERT_STRING_EQUAL(found("*", 0), "cook@red");
    CU_ASSERT_STRING_EQUAL(found("*", 1), "mapper@blue");
    CU_ASSERT_STRING_EQUAL(found("*", 1), "mapper@blue");
    CU_ASSERT_STRING_EQUAL(found("*", 2), "mapper@red");
    CU_ASSERT_STRING_EQUAL(found("*", 3), "nobody");
    CU_ASSERT_STRING_EQUAL(found("*", 0), "cook@red");
    CU_ASSERT_STRING_EQUAL(found("* x<2", 0), "mapper@red");
    CU_ASSERT_STRING_EQUAL(found("* x<2", 1), "nobody");
    CU_ASSERT_STRING_EQUAL(found("*", 1000000), "nobody");
    CU_ASSERT_STRING_EQUAL(found("", 0), "nobody");
    CU_ASSERT_STRING_EQUAL(found("", 0), "nobody");
    CU_ASSERT_STRING_EQUAL(found("* x", 0), "nobody");
    CU_ASSERT_PTR_NULL(mu_process_find_service(&process, NULL, 0));
    CU_ASSERT_STRING_EQUAL(found("* x<2", 0), "mapper@red");
    offer("mapper", "red", "x=3"); /* the pages have changed: the search begins anew */
    CU_ASSERT_STRING_EQUAL(found("* x<2", 0), "nobody");
    offer("mapper", "red", NULL);
    offer("mapper", "red", NULL);
    CU_ASSERT_STRING_EQUAL(found("mapper", 0), "mapper@blue");
    CU_ASSERT_STRING_EQUAL(found("mapper", 1), "nobody");
}

static void test_watching(void)
{
    offer("mapper", "blue", "x=1");
    CU_ASSERT_EQUAL(mu_agent_watch_service(red, "mapper x<3"), MU_OK);
    CU_ASSERT_EQUAL(mu_agent_watch_service(red, "mapper x<3"), MU_OK); /* once is enough */
    HEARD("");
    step_flush(&process);
    HEARD("red: +mapper@blue[x=1]; ");
    offer("mapper", "blue", "x=2");
    offer("cook", "blue", "x=2");
    HEARD("");
    offer("mapper", "blue", "x=4");
    HEARD("red: -mapper@blue[x=4]; ");
    offer("mapper", "grey", "x=0");
    offer("mapper", "grey", NULL);
    HEARD("red: +mapper@grey[x=0]; red: -mapper@grey[x=0]; ");
    offer("mapper", "green", "x=0"); /* in the same place */
    HEARD("red: +mapper@green[x=0]; ");
    verdict(5);
    verdict(6); /* another broker has other pages */
    HEARD("red: -mapper@green[x=0]; ");
    offer("mapper", "green", "x=0");
    HEARD("red: +mapper@green[x=0]; ");
    mu_agent_set_state(red, MU_GONE);
    offer("mapper", "green", NULL);
    HEARD("");
}

static void test_a_lock_step_begins_with_new_pages(void)
{
    static const muster_Sense sense = {.step = 0, .lockstep = true};
    muster_Delivery d = {.process = words("p1"), .step = -1};
    CU_ASSERT_EQUAL(mu_agent_watch_service(red, "*"), MU_OK);
    offer("mapper", "blue", "");
    member("scouts", "blue", true);
    HEARD("red: +mapper@blue[]; ");
    capture_begin(); /* the answer finds no network */
    (void)process_step_on(&process, STEP_LOCKSTEP);
    step_live(&process, &sense, &d);
    capture_end();
    HEARD("");
    CU_ASSERT_PTR_NULL(mu_process_group(&process, 0));
    CU_ASSERT_PTR_NULL(mu_process_find_service(&process, "*", 0));
    offer("mapper", "blue", "");
    HEARD("red: +mapper@blue[]; ");
}

static const muster_Mail *sent(mu_agent *a)
{
    static muster_Mail m;
    CU_ASSERT_EQUAL_FATAL(outbox_unsent(&a->outbox, &m, 1), 1);
    outbox_sent(&a->outbox, 1);
    outbox_confirm(&a->outbox, 1, m.seq);
    return &m;
}

static void test_changes_are_mails_to_the_broker(void)
{
    mu_agent *deaf = join("deaf", false);
    CU_ASSERT_EQUAL(mu_agent_group_create(red, "scouts"), MU_OK);
    const muster_Mail *m = sent(red);
    CU_ASSERT_STRING_EQUAL(m->dst, "broker");
    CU_ASSERT_EQUAL(m->layer, 2);
    CU_ASSERT_STRING_EQUAL(m->performative, "group-create");
    CU_ASSERT_STRING_EQUAL(m->content, "scouts");
    CU_ASSERT_NOT_EQUAL(m->reply_with[0], '\0');
    CU_ASSERT_EQUAL(mu_agent_group_join(deaf, "scouts"), MU_OK);
    m = sent(deaf);
    CU_ASSERT_STRING_EQUAL(m->performative, "group-join");
    CU_ASSERT_STRING_EQUAL(m->reply_with, ""); /* nobody would hear the answer */
    CU_ASSERT_EQUAL(mu_agent_group_leave(red, "scouts"), MU_OK);
    CU_ASSERT_STRING_EQUAL(sent(red)->performative, "group-leave");
    CU_ASSERT_EQUAL(mu_agent_group_send(red, "scouts", "gold"), MU_OK);
    m = sent(red);
    CU_ASSERT_STRING_EQUAL(m->dst, "group:scouts");
    CU_ASSERT_STRING_EQUAL(m->content, "gold");
    CU_ASSERT_EQUAL(mu_agent_advertise(red, "mapper", "a=\"\\", 1500000000), MU_OK);
    m = sent(red);
    CU_ASSERT_STRING_EQUAL(m->performative, "advertise");
    CU_ASSERT_STRING_EQUAL(m->content, "mapper \"a=\\\"\\\\\" 1.500000000");
    CU_ASSERT_EQUAL(mu_agent_advertise(red, "mapper", NULL, 0), MU_OK);
    CU_ASSERT_STRING_EQUAL(sent(red)->content, "mapper \"\" 0.000000000");
    CU_ASSERT_EQUAL(mu_agent_withdraw(red, "mapper"), MU_OK);
    CU_ASSERT_STRING_EQUAL(sent(red)->performative, "withdraw");

    CU_ASSERT_EQUAL(mu_agent_group_join(red, "a b"), MU_MALFORMED);
    CU_ASSERT_EQUAL(mu_agent_group_create(red, NULL), MU_MALFORMED);
    CU_ASSERT_EQUAL(mu_agent_group_leave(red, ""), MU_MALFORMED);
    CU_ASSERT_EQUAL(mu_agent_group_send(red, "1", "x"), MU_MALFORMED);
    CU_ASSERT_EQUAL(mu_agent_advertise(red, "mapper", "a", 0), MU_MALFORMED);
    CU_ASSERT_EQUAL(mu_agent_watch_service(red, "mapper x=>1"), MU_MALFORMED);
    CU_ASSERT_EQUAL(mu_agent_watch_service(red, NULL), MU_MALFORMED);
    CU_ASSERT_EQUAL(red->outbox.first_seq, red->outbox.next_seq);
}

static void test_answers_do_not_reach_on_mail(void)
{
    char mark[MU_FIELD_MAX + 1];
    CU_ASSERT_EQUAL(mu_agent_group_create(red, "scouts"), MU_OK);
    snprintf(mark, sizeof mark, "%s", sent(red)->reply_with);
    answer("broker", "inform", mark, "group-create scouts");
    HEARD("");
    answer("broker", "failure", mark, "group-exists scouts");
    HEARD("red: no group-create scouts: group-exists; ");
    answer("blue", "failure", mark, "group-exists scouts"); /* not the broker's word */
    HEARD("red: blue group-exists scouts; ");
    answer("broker", "inform", "mine", "members red");
    HEARD("red: broker members red; ");
    CU_ASSERT_EQUAL(red->last_number, 4);
}

static void test_limit_watches(void)
{
    char query[64];
    for (int i = 0; i < MU_WATCHES_MAX; i++) {
        snprintf(query, sizeof query, "mapper x<%d", i);
        CU_ASSERT_EQUAL(mu_agent_watch_service(red, query), MU_OK);
    }
    CU_ASSERT_EQUAL(mu_agent_watch_service(red, "cook"), MU_FULL);
    CU_ASSERT_EQUAL(mu_agent_watch_service(red, "mapper x<3"), MU_OK);
}

/* The place of who is gone is given to others, who have asked for nothing. */
static void test_who_leaves_watches_no_more(void)
{
    char query[64];
    mu_agent *blue = join("blue", false);
    CU_ASSERT_EQUAL(mu_agent_watch_service(blue, "cook"), MU_OK);
    for (int i = 1; i < MU_WATCHES_MAX; i++) {
        snprintf(query, sizeof query, "mapper x<%d", i);
        CU_ASSERT_EQUAL(mu_agent_watch_service(red, query), MU_OK);
    }
    mu_agent_set_state(red, MU_GONE);
    CU_ASSERT_EQUAL(mu_agent_watch_service(red, "cook"), MU_REFUSED);
    mu_agent *green = join("green", false);
    CU_ASSERT_PTR_EQUAL(green, red);
    offer("mapper", "yellow", "x=0");
    HEARD("");
    for (int i = 1; i < MU_WATCHES_MAX; i++) {
        snprintf(query, sizeof query, "cook x<%d", i);
        CU_ASSERT_EQUAL(mu_agent_watch_service(green, query), MU_OK);
    }
    CU_ASSERT_EQUAL(mu_agent_watch_service(green, "baker"), MU_FULL);
    offer("cook", "yellow", "");
    HEARD("blue: +cook@yellow[]; ");
}

/* Leaves at the first news, and another agent goes on in its place. */
static void on_service_leave(void *self, mu_agent *a, const struct mu_service *service, bool came)
{
    on_service(self, a, service, came);
    mu_agent_set_state(a, MU_GONE);
    red = join("green", false);
    CU_ASSERT_EQUAL(mu_agent_watch_service(red, "*"), MU_OK);
}

static void test_who_leaves_while_it_is_told(void)
{
    (void)join("blue", false);
    offer("cook", "yellow", "");
    offer("mapper", "yellow", "");
    red->handlers.on_service = on_service_leave;
    CU_ASSERT_EQUAL(mu_agent_watch_service(red, "*"), MU_OK);
    directory_settle(&process.directory);
    HEARD("red: +cook@yellow[]; green: +mapper@yellow[]; green: +cook@yellow[]; ");
    offer("cook", "yellow", NULL);
    HEARD("green: -cook@yellow[]; ");
}

static void test_limit_lines(void)
{
    char name[MU_NAME_MAX + 1];
    for (int i = 0; i < MU_GROUPS_MAX + 3; i++) {
        snprintf(name, sizeof name, "g%d", i);
        member(name, "", true);
    }
    CU_ASSERT_PTR_NOT_NULL(mu_process_group(&process, MU_GROUPS_MAX - 1));
    CU_ASSERT_PTR_NULL(mu_process_group(&process, MU_GROUPS_MAX));
    for (int i = 0; i < MU_MEMBERSHIPS_MAX + 3; i++) {
        snprintf(name, sizeof name, "m%d", i);
        member("g1", name, true);
    }
    CU_ASSERT_EQUAL(process.directory.members.count, MU_MEMBERSHIPS_MAX);
    for (int i = 0; i < MU_SERVICES_MAX + 3; i++) {
        snprintf(name, sizeof name, "s%d", i);
        offer(name, "red", "");
    }
    CU_ASSERT_EQUAL(process.directory.offers.count, MU_SERVICES_MAX);
    directory_clear(&process.directory, true);
    CU_ASSERT_PTR_NULL(mu_process_group(&process, 0));
    member("g1", "m1", true);
    CU_ASSERT_STRING_EQUAL(mu_process_group(&process, 0), "g1");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"groups", test_groups},
        {"finding", test_finding},
        {"watching", test_watching},
        {"a lock step begins with new pages", test_a_lock_step_begins_with_new_pages},
        {"changes are mails to the broker", test_changes_are_mails_to_the_broker},
        {"answers do not reach on_mail", test_answers_do_not_reach_on_mail},
        {"who leaves watches no more", test_who_leaves_watches_no_more},
        {"who leaves while it is told", test_who_leaves_while_it_is_told},
        {"limit: watches", test_limit_watches},
        {"limit: lines", test_limit_lines},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"runtime/directory", NULL, NULL, set_up, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
