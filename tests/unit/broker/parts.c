/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "broker_story.h"

static muster_Mail question(const char *src, uint64_t seq, const char *dst)
{
    muster_Mail m = letter(src, seq, dst, "");
    m.layer = 2;
    m.performative = words("state");
    return m;
}

static void team(uint64_t interval_ns)
{
    story_begin_with(interval_ns, false);
    story.now_ns = 1000 * MS;
    story_join("red");
    story_join("green");
    story_join("operator");
    story_tick(1000 * MS); /* the dispatcher has slept enough */
    (void)story_collect();
    story_tick(1000 * MS);
}

static void lockstep_begin(uint64_t step_ms)
{
    char *names[] = {words("p-red"), words("p-green")};
    muster_Roster roster = {.simulator = words("sim"), .lockstep = true, .step_ns = step_ms * MS};
    roster.processes = (dds_sequence_string){._length = 2, ._buffer = names};
    story_match("sim");
    broker_roster(story.b, &roster, story.now_ns);
    (void)story_collect();
}

/* One step; red sends a mail of that number in it, unless it is 0.  @return what is handed out */
static const char *step(int64_t number, uint64_t seq)
{
    char content[16];
    snprintf(content, sizeof content, "m%llu", (unsigned long long)seq);
    muster_Mail m = letter("red", seq, "green", content);
    story_up("red", number, muster_STATE_RUNNING, &m, seq > 0, 0);
    story_up("green", number, muster_STATE_RUNNING, NULL, 0, 0);
    return story_collect();
}

/* @return a counter of a part, as any DDS tool sees it */
static uint64_t counter(const char *part, const char *name)
{
    muster_PartStatus s;
    for (uint32_t i = 1; broker_part(story.b, i, &s); i++) {
        for (uint32_t k = 0; strcmp(s.part, part) == 0 && k < s.counters._length; k++) {
            if (strcmp(s.counters._buffer[k].name, name) == 0) {
                return s.counters._buffer[k].value;
            }
        }
    }
    CU_FAIL("no such counter");
    return 0;
}

/* --- the parts in the white pages ------------------------------------------------------------- */

static void test_every_part_has_its_line(void)
{
    static const char *const names[] = {"names",    "mail",  "delivery", "groups",
                                        "services", "trust", "journal",  "federation"};
    char name[64], want[96];
    team(0);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        snprintf(name, sizeof name, "broker.%s", names[i]);
        snprintf(want, sizeof want, "%s running ", name);
        CU_ASSERT_STRING_EQUAL(story_member(name), want);
        uint32_t agent = registry_find(&story.b->registry, name);
        CU_ASSERT_TRUE(registry_is_own(agent));
        CU_ASSERT_EQUAL(story.b->registry.agents[agent].is.kind, muster_KIND_SPECIAL);
        CU_ASSERT_EQUAL(story.b->registry.agents[agent].is.pid, 9);
    }
    CU_ASSERT_EQUAL(story_status().agents, 3); /* they are no agents */
}

static void test_nobody_takes_a_part_s_name(void)
{
    team(0);
    story_register("broker.delivery", "p-thief");
    story_match("p-thief");
    EXPECT("broker.delivery: reserved name");
    story_gone("p-thief");
    CU_ASSERT_STRING_EQUAL(story_member("broker.delivery"), "broker.delivery running ");
}

static void test_broadcasts_pass_the_parts_by(void)
{
    team(0);
    story_send("red", 1, "all", "hello");
    EXPECT("green #1 red/1 hello; operator #1 red/1 hello");
    story_send("red", 2, "special", "you");
    EXPECT("operator #2 red/2 you");
}

static void test_a_part_answers_for_its_state(void)
{
    team(0);
    story_send("red", 1, "green", "one");
    EXPECT("green #1 red/1 one");
    story_mail(question("red", 2, "broker.trust"));
    EXPECT("red #1 broker.trust/4611686018427387905 trust lines 2 allowed 0 refused 0 probes 0 "
           "probes-declined 0 probes-lost 0 audited 0 audit-lost 0 audit-failed 0 glances 0 "
           "glances-declined 0 glances-lost 0; red 2-2 delivered");
    story_mail(question("red", 3, "broker.groups"));
    EXPECT("red #2 broker.groups/4611686018427387906 groups groups 0 members 0 lines 0 changes 0; "
           "red 3-3 delivered");
    story_mail(question("red", 4, "broker"));
    const char *all = story_collect();
    CU_ASSERT_PTR_NOT_NULL(strstr(all, "red #3 broker/4611686018427387907 broker names.agents "
                                       "3 "));
    CU_ASSERT_PTR_NOT_NULL(strstr(all, " mail.sent 6 mail.delivered 3 "));
    CU_ASSERT_PTR_NOT_NULL(strstr(all, " delivery.items 3 delivery.most-items 1 "));
    story_send("red", 5, "broker.trust", "hello");
    EXPECT("red #4 broker.trust/4611686018427387908 performative tell; red 5-5 delivered");
}

static void check_answer(const char *part, uint64_t seq, const char *want)
{
    story_mail(question("red", seq, part));
    const char *got = story_collect();
    if (!strstr(got, want)) {
        READS(got, want);
    }
}

/* For one version. */
static void test_the_names_of_the_version_before(void)
{
    team(0);
    story_send("red", 1, "green", "one");
    (void)story_collect();
    check_answer("broker.courier", 2, " broker.delivery/4611686018427387905 delivery deliveries ");
    check_answer("broker.courier", 3, " delay-ns 0 circulars 0 parcels 2 most-parcels 1; ");
    check_answer("broker.delivery", 4, " delay-ns 0 circulars 0 parcels 3 most-parcels 1; ");
    check_answer("broker.registrar", 5, " sockets-refused 0 capsules 0 capsules-kept 0 ");
    check_answer("broker.postmaster", 6, " broker.mail/4611686018427387909 mail sent ");
    check_answer("broker.liaison", 7, " parcels-in 0; ");
    check_answer("broker", 8, " federation.earlier-lives 0 registrar.agents 3 ");
    check_answer("broker", 9, " courier.parcels 8 ");
    check_answer("broker", 10, " trust.glances 0 ");
    story_register("broker.courier", "p-thief");
    story_match("p-thief");
    EXPECT("broker.courier: reserved name");
}

static void test_every_counter_is_in_one_part_once(void)
{
    const struct metric *c, *d;
    for (size_t i = 0; (c = metrics_at(i)); i++) {
        CU_ASSERT_TRUE(c->part >= 1 && c->part < PARTS_END);
        CU_ASSERT_TRUE(c->read || c->size == 4 || c->size == 8);
        CU_ASSERT_TRUE(i == 0 || metrics_at(i - 1)->part <= c->part);
        for (size_t k = 0; k < i; k++) {
            d = metrics_at(k);
            CU_ASSERT_FALSE(d->part == c->part && strcmp(d->name, c->name) == 0);
        }
    }
    CU_ASSERT_PTR_NULL(metrics_part_name(PARTS_END));
}

static void test_part_status_is_the_table(void)
{
    muster_PartStatus s;
    size_t counters = 0, known = 0;
    uint32_t part = 1;
    team(0);
    for (; broker_part(story.b, part, &s); part++) {
        CU_ASSERT_STRING_EQUAL(s.broker, "alpha");
        CU_ASSERT_EQUAL(strncmp(s.part, "broker.", 7), 0);
        counters += s.counters._length;
    }
    while (metrics_at(known)) {
        known++;
    }
    CU_ASSERT_EQUAL(part, PARTS_END);
    CU_ASSERT_EQUAL(counters, known);
    CU_ASSERT_EQUAL(counter("broker.names", "agents"), 3);
    CU_ASSERT_FALSE(broker_part(story.b, 0, &s));
}

static void test_the_age_of_the_oldest_mail(void)
{
    team(0);
    story_state("green", muster_STATE_SUSPENDED);
    CU_ASSERT_EQUAL(story_status().oldest_ns, 0);
    muster_Mail m = letter("red", 1, "green", "first");
    m.ttl_ns = 50 * MS;
    story_mail(m);
    story_tick(20 * MS);
    story_send("red", 2, "green", "second");
    story_tick(20 * MS);
    CU_ASSERT_EQUAL(story_status().oldest_ns, 40 * MS);
    CU_ASSERT_EQUAL(story_status().stored, 2);
    story_tick(20 * MS); /* the first has expired */
    CU_ASSERT_EQUAL(story_status().oldest_ns, 40 * MS);
    CU_ASSERT_EQUAL(story_status().stored, 1);
    story_send("red", 3, "operator", "third");
    story_state("green", muster_STATE_RUNNING);
    (void)story_collect();
    story_ack("operator", 1); /* out of order: one in the list's middle or at its end */
    CU_ASSERT_EQUAL(story_status().oldest_ns, 40 * MS);
    story_ack("green", 1);
    CU_ASSERT_EQUAL(story_status().oldest_ns, 0);
    CU_ASSERT_EQUAL(story_status().stored, 0);
}

/* Each receiver of a mail is in one of these. */
static const char *const fates[] = {"delivered",  "waiting",      "expired", "dropped", "box-full",
                                    "over-share", "unknown-name", "refused", "no-store"};

static void sum_check(void)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < sizeof fates / sizeof fates[0]; i++) {
        sum += counter("broker.mail", fates[i]);
    }
    CU_ASSERT_EQUAL(counter("broker.mail", "sent"), sum);
}

static void commit(bool ok)
{
    muster_Level level;
    struct journal_entry entry;
    while (journal_wanted(story.b, &level)) {
        while (journal_next(story.b, &entry)) {
        }
        durable_committed(story.b, ok, story.now_ns);
    }
}

static void test_every_mail_is_accounted_for(void)
{
    struct broker_options options = {
        .name = "alpha", .has_store = true, .boxes = {muster_BOX_DROP_OLDEST, 8, 0}};
    uint64_t seq = 0;
    team(0);
    story.b = broker_kept(&options);
    story_join("red");
    story_join("green");
    story_join("operator");
    story_state("green", muster_STATE_SUSPENDED);
    (void)story_collect();
    for (int i = 0; i < 20; i++) { /* the box of one who listens to nobody, and drops */
        muster_Mail m = letter("red", ++seq, "green,nobody,operator", "m");
        m.ttl_ns = i % 3 == 0 ? 10 * MS : 0;
        story_mail(m);
        (void)story_collect();
        sum_check();
    }
    story_tick(20 * MS);
    muster_Mail m = directive("operator", 1, "green", "(wander)");
    m.src = words("red");
    m.seq = ++seq;
    story_mail(m); /* is refused */
    m = letter("red", ++seq, "broker", "scouts green");
    m.layer = 2;
    m.performative = words("group-join");
    story_mail(m); /* is delivered, and what it says refused */
    CU_ASSERT_EQUAL(counter("broker.trust", "refused"), 2);
    CU_ASSERT_EQUAL(counter("broker.mail", "refused"), 1);
    m = letter("red", ++seq, "red", "m");
    m.level = muster_LEVEL_LOGGED;
    story_mail(m);
    commit(false);
    m.seq = ++seq;
    story_mail(m); /* the disk is not there for a second */
    sum_check();
    CU_ASSERT_EQUAL(counter("broker.mail", "no-store"), 2);
    CU_ASSERT_EQUAL(counter("broker.journal", "failures"), 1);
    story_tick(2000 * MS);
    m.seq = ++seq;
    story_mail(m);
    commit(true);
    CU_ASSERT_TRUE(counter("broker.journal", "commits") > 0);
    (void)story_collect();
    sum_check();
    for (size_t i = 0; i < 4; i++) {
        CU_ASSERT_TRUE(counter("broker.mail", fates[i]) > 0 || i == 0);
    }
    CU_ASSERT_TRUE(counter("broker.mail", "unknown-name") > 0);
}

static void test_groups_and_services_are_counted(void)
{
    static const struct {
        const char *performative, *content;
        uint64_t groups, members, offers;
    } says[] = {
        {"group-create", "scouts", 1, 0, 0},      {"group-join", "scouts", 1, 1, 0},
        {"group-join", "scouts", 1, 1, 0},        {"group-join", "cooks", 2, 2, 0},
        {"group-leave", "scouts", 1, 1, 0},       {"advertise", "mapper", 1, 1, 1},
        {"advertise", "mapper \"x=1\"", 1, 1, 1}, {"withdraw", "mapper", 1, 1, 0},
        {"advertise", "mapper \"\" 1", 1, 1, 1},
    };
    team(0);
    for (size_t i = 0; i < sizeof says / sizeof says[0]; i++) {
        muster_Mail m = letter("red", i + 1, "broker", says[i].content);
        m.layer = 2;
        m.performative = words(says[i].performative);
        story_mail(m);
        CU_ASSERT_EQUAL(counter("broker.groups", "groups"), says[i].groups);
        CU_ASSERT_EQUAL(counter("broker.groups", "members"), says[i].members);
        CU_ASSERT_EQUAL(counter("broker.services", "offers"), says[i].offers);
    }
    story_tick(1000 * MS); /* the lease is over */
    CU_ASSERT_EQUAL(counter("broker.services", "offers"), 0);
    CU_ASSERT_EQUAL(counter("broker.services", "lines"), 1);
}

/* --- in lock step ----------------------------------------------------------------------------- */

static void test_members_of_a_lock_step_see_no_parts(void)
{
    team(0);
    lockstep_begin(100);
    muster_Mail asks[] = {question("red", 1, "broker.delivery"), question("red", 2, "broker")};
    story_up("red", 0, muster_STATE_RUNNING, asks, 2, 0);
    story_up("green", 0, muster_STATE_RUNNING, NULL, 0, 0);
    EXPECT("p-red@0; red #1 broker/1 in-lock-step; red 1-1 unknown-name; red 2-2 delivered; "
           "p-green@0; sim@0");
}

static void test_pages_in_lock_step_show_no_parts(void)
{
    team(0);
    char *names[] = {words("p-red"), words("p-green")};
    muster_Roster roster = {.simulator = words("sim"), .lockstep = true, .step_ns = 100 * MS};
    roster.processes = (dds_sequence_string){._length = 2, ._buffer = names};
    broker_roster(story.b, &roster, story.now_ns);
    const char *process;
    muster_Delivery d;
    unsigned lines = 0;
    while (broker_next(story.b, &process, &d)) {
        for (uint32_t i = 0; i < d.members._length; i++) {
            CU_ASSERT_NOT_EQUAL(strncmp(d.members._buffer[i].name, "broker.", 7), 0);
            lines++;
        }
        broker_delivered(story.b, story.now_ns);
    }
    CU_ASSERT_EQUAL(lines, 2 * 4); /* broker, red, green, operator; for each process */
}

/* --- the delivery interval -------------------------------------------------------------------- */

static void test_at_most_once_an_interval(void)
{
    team(50 * MS);
    story_send("red", 1, "green", "one");
    EXPECT("green #1 red/1 one"); /* the dispatcher had slept long enough */
    story_send("red", 2, "green", "two");
    story_tick(20 * MS);
    story_send("red", 3, "green", "three");
    EXPECT("");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), story.now_ns + 30 * MS);
    story_tick(29 * MS);
    EXPECT("");
    story_tick(1 * MS);
    EXPECT("green #2 red/2 two; green #3 red/3 three");
    CU_ASSERT_EQUAL(counter("broker.delivery", "delay-ns"), (50 + 30) * MS);
    CU_ASSERT_EQUAL(counter("broker.delivery", "most-items"), 2);
    CU_ASSERT_EQUAL(counter("broker.delivery", "items"), 3);
    story_ack("green", 3);
    EXPECT("");
    story_tick(50 * MS);
    EXPECT("red 1-3 delivered");
    story_tick(1000 * MS);
    EXPECT("");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), UINT64_MAX); /* nobody waits: it sleeps on */
}

static void test_more_than_one_delivery_can_hold(void)
{
    team(50 * MS);
    story_state("green", muster_STATE_SUSPENDED);
    (void)story_collect();
    static char much[MU_CONTENT_MAX + 1];
    memset(much, 'x', MU_CONTENT_MAX);
    for (uint64_t i = 1; i <= 20; i++) {
        story_send("red", i, "green", much);
    }
    story_state("green", muster_STATE_RUNNING);
    story_tick(60 * MS);
    uint64_t before = counter("broker.delivery", "deliveries");
    (void)story_collect();
    CU_ASSERT_TRUE(counter("broker.delivery", "deliveries") >= before + 3);
    CU_ASSERT_EQUAL(story.b->mailbox.boxes[registry_find(&story.b->registry, "green")].written, 20);
}

static void test_directives_and_verdicts_go_at_once(void)
{
    team(50 * MS);
    story_send("red", 1, "green", "one");
    EXPECT("green #1 red/1 one");
    story_send("red", 2, "green", "two");
    EXPECT("");
    story_mail(directive("operator", 1, "green", "(wander)"));
    EXPECT("green #2 operator/1 (wander)");
    story_register("blue", "p-blue");
    story_match("p-blue");
    EXPECT("blue welcome 0");
    story_register("operator", "p-blue");
    story_tick(50 * MS);
    EXPECT("green #3 red/2 two");
}

/* green acknowledges nothing, and its window is full of directives; blue is in the same process. */
static void test_who_shares_a_process_with_a_full_window_is_not_forgotten(void)
{
    uint64_t seq = 0;
    team(60000 * MS);
    story_register("blue", "p-green");
    (void)story_collect();
    while (seq < MU_WINDOW_MAX + MAILBOX_RESERVE) {
        story_mail(directive("operator", ++seq, "green", "(wander)"));
        (void)story_collect();
    }
    story_send("red", 1, "blue", "hello");
    story_mail(directive("operator", ++seq, "green", "(wander)"));
    EXPECT("");
    uint32_t place = processes_find(&story.b->processes, "p-green");
    CU_ASSERT_EQUAL(processes_stirred_agent(&story.b->processes, place), MU_NONE);
    story_ack("green", 1); /* which makes room for the directive */
    CU_ASSERT_NOT_EQUAL(processes_stirred_agent(&story.b->processes, place), MU_NONE);
    EXPECT("green #209 operator/209 (wander)");
    CU_ASSERT_EQUAL(processes_stirred_agent(&story.b->processes, place), MU_NONE);
    CU_ASSERT_EQUAL(dispatch_deadline_ns(story.b), story.b->dispatch.wake_ns);
    story.now_ns = story.b->dispatch.wake_ns - 1;
    story_tick(1);
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "blue #1 red/1 hello"));
}

static void test_the_network_refuses_meanwhile(void)
{
    const char *process;
    muster_Delivery d;
    team(50 * MS);
    story_send("red", 1, "green", "one");
    CU_ASSERT_TRUE_FATAL(broker_next(story.b, &process, &d));
    broker_undelivered(story.b);
    story_tick(2 * MS);
    EXPECT("green #1 red/1 one");
    CU_ASSERT_EQUAL(counter("broker.delivery", "blocked"), 1);
}

static void test_the_interval_is_tuned_by_directive(void)
{
    static const char *const wrong[] = {
        "(delivery-interval)",       "(delivery-interval -1)",    "(delivery-interval 60001)",
        "(delivery-interval nan)",   "(delivery-interval 5 5)",   "(delivery-interval five)",
        "(delivery-interval \"5\")", "(delivery-interval 5) (x)",
    };
    static const char *const unknown[] = {"(delivery 5)", "delivery-interval 5", "(", "",
                                          "()",           "(delivery-interval 5"};
    char want[256];
    team(0);
    uint64_t seq = 0;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        story_mail(directive("operator", ++seq, "broker", wrong[i]));
        snprintf(
            want, sizeof want,
            "operator #%llu broker/%llu \"delivery-interval: expected milliseconds, from 0 (at "
            "once) to 60000\"; operator %llu-%llu delivered",
            (unsigned long long)seq, 4611686018427387904ull + seq, (unsigned long long)seq,
            (unsigned long long)seq);
        EXPECT(want);
    }
    for (size_t i = 0; i < sizeof unknown / sizeof unknown[0]; i++) {
        story_mail(directive("operator", ++seq, "broker", unknown[i]));
        CU_ASSERT_PTR_NOT_NULL(
            strstr(story_collect(), "\"the broker carries out: (delivery-interval MS)\""));
    }
    CU_ASSERT_EQUAL(counter("broker.delivery", "interval-ns"), 0);
    story_mail(directive("operator", ++seq, "broker", " ( delivery-interval\t20 ) "));
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), " delivery-interval 20;"));
    CU_ASSERT_EQUAL(counter("broker.delivery", "interval-ns"), 20 * MS);
    story_mail(directive("operator", ++seq, "broker.delivery", "(delivery-interval 0)"));
    story_tick(20 * MS);
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), " delivery-interval 0;"));
    story_mail(directive("operator", ++seq, "broker.trust", "(delivery-interval 7)"));
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "the broker carries out"));
    CU_ASSERT_EQUAL(counter("broker.delivery", "interval-ns"), 0);
    muster_Mail m = directive("operator", ++seq, "broker", "");
    m.performative = words("suspend");
    story_mail(m);
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), " suspend unsupported;"));
}

static void test_in_lock_step_the_interval_is_whole_steps(void)
{
    team(250 * MS); /* three steps of 100 ms */
    lockstep_begin(100);
    CU_ASSERT_STRING_EQUAL(step(0, 1), "p-green@0; p-red@0; sim@0");
    CU_ASSERT_STRING_EQUAL(step(1, 2), "p-green@1; p-red@1; sim@1");
    CU_ASSERT_STRING_EQUAL(step(2, 3), "p-green@2; green #1 red/1 m1; green #2 red/2 m2; "
                                       "green #3 red/3 m3; p-red@2; sim@2");
    CU_ASSERT_EQUAL(counter("broker.delivery", "delay-ns"), (200 + 100 + 0) * MS);
    story_tick(10000 * MS); /* the wall clock says nothing here */
    CU_ASSERT_STRING_EQUAL(step(3, 4), "p-green@3; p-red@3; sim@3");
    muster_Mail m = directive("operator", 1, "green", "(wander)");
    story_mail(m);
    CU_ASSERT_STRING_EQUAL(step(4, 5), "p-green@4; green #4 operator/1 (wander); p-red@4; sim@4; "
                                       "outside operator/1");
    CU_ASSERT_STRING_EQUAL(step(5, 0), "p-red@5; p-green@5; green #5 red/4 m4; green #6 red/5 m5; "
                                       "sim@5");
}

static void test_in_lock_step_the_broker_is_directed_between_steps(void)
{
    team(0);
    lockstep_begin(100);
    story_mail(directive("operator", 1, "broker", "(delivery-interval 200)"));
    EXPECT("");
    CU_ASSERT_EQUAL(counter("broker.delivery", "interval-ns"), 0);
    const char *out = step(0, 1);
    CU_ASSERT_PTR_NOT_NULL(strstr(out, "outside operator/1"));
    CU_ASSERT_EQUAL(counter("broker.delivery", "interval-ns"), 200 * MS);
    CU_ASSERT_PTR_NULL(strstr(out, "m1"));
    CU_ASSERT_PTR_NOT_NULL(strstr(step(1, 0), "green #1 red/1 m1"));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"every part has its line", test_every_part_has_its_line},
        {"nobody takes a part's name", test_nobody_takes_a_part_s_name},
        {"broadcasts pass the parts by", test_broadcasts_pass_the_parts_by},
        {"a part answers for its state", test_a_part_answers_for_its_state},
        {"the names of the version before", test_the_names_of_the_version_before},
        {"every counter is in one part once", test_every_counter_is_in_one_part_once},
        {"PartStatus is the table", test_part_status_is_the_table},
        {"the age of the oldest mail", test_the_age_of_the_oldest_mail},
        {"every mail is accounted for", test_every_mail_is_accounted_for},
        {"groups and services are counted", test_groups_and_services_are_counted},
        {"members of a lock step see no parts", test_members_of_a_lock_step_see_no_parts},
        {"pages in lock step show no parts", test_pages_in_lock_step_show_no_parts},
        {"at most once an interval", test_at_most_once_an_interval},
        {"more than one delivery can hold", test_more_than_one_delivery_can_hold},
        {"directives and verdicts go at once", test_directives_and_verdicts_go_at_once},
        {"who shares a process with a full window is not forgotten",
         test_who_shares_a_process_with_a_full_window_is_not_forgotten},
        {"the network refuses meanwhile", test_the_network_refuses_meanwhile},
        {"the interval is tuned by directive", test_the_interval_is_tuned_by_directive},
        {"in lock step the interval is whole steps", test_in_lock_step_the_interval_is_whole_steps},
        {"in lock step the broker is directed between steps",
         test_in_lock_step_the_broker_is_directed_between_steps},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/parts", tests);
}
