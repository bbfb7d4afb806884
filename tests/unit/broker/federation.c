/* SPDX-License-Identifier: Apache-2.0 */
/* Several brokers: one name space, mail from one to the other, and what happens when a link or a
 * broker goes. */
#include "broker_net.h"
#include "bus/check.h"

enum { A, B, C };

static void two(void)
{
    net_begin();
    net_link(A, B, true);
    net_join("red", A);
    net_join("blue", B);
    net_settle();
}

static void chain(void)
{
    net_begin();
    net_link(A, B, true);
    net_link(B, C, true);
    net_join("red", A);
    net_join("green", C);
    net_settle();
}

static void triangle(void)
{
    chain();
    net_link(A, C, true);
    net_settle();
}

static void test_agents_are_known_everywhere(void)
{
    two();
    LIVES(A, "blue", "b running");
    LIVES(B, "red", "a running");
    LIVES(B, "green", "nobody");
    net_leave("red");
    net_settle();
    LIVES(B, "red", "a absent");
    CU_ASSERT_EQUAL(net.b[B]->federation.peers_there, 1);
}

static void test_a_lookup_names_the_broker_at_which_an_agent_lives(void)
{
    two();
    net_ask("red", "lookup", "blue");
    net_settle();
    HEARD("red", "member blue agent running b here 1");
    net_ask("red", "lookup", "red");
    net_settle();
    HEARD("red", "member red agent running a here 1");
}

static void test_mail_crosses(void)
{
    two();
    net_send("red", "blue", "one");
    net_send("red", "blue", "two");
    net_settle();
    HEARD("blue", "one; two");
    TOLD("red", "1-2 stored; 1-2 delivered");
    net_send("blue", "red,nobody", "three");
    net_settle();
    HEARD("red", "three");
    TOLD("blue", "1-1 unknown-name; 1-1 delivered");
    CU_ASSERT_EQUAL(net.b[A]->pool.mails, 0);
    CU_ASSERT_EQUAL(net.b[B]->pool.mails, 0);
    CU_ASSERT_EQUAL(net.b[A]->federation.count.passed_on, 2);
    CU_ASSERT_EQUAL(net.b[B]->federation.count.items_in, 2);
}

static void test_mail_waits_for_who_is_absent(void)
{
    two();
    net_leave("blue");
    net_settle();
    net_send("red", "blue", "one");
    net_settle();
    TOLD("red", "1-1 stored");
    net_join_as("blue", "2", A, 9000);
    net_settle();
    READ(net.agents[2].heard, "one");
    TOLD("red", "1-1 delivered");
}

static void test_what_is_lost_or_comes_twice(void)
{
    two();
    net.twice[A] = true;
    net_send("red", "blue", "one");
    net_settle();
    HEARD("blue", "one");
    net.deaf[A] = true;
    net_send("red", "blue", "two");
    net_settle();
    HEARD("blue", "two");
    TOLD("red", "1-1 stored; 1-1 delivered; 2-2 delivered");
    CU_ASSERT_EQUAL(net.b[A]->pool.mails, 1);
    net.deaf[A] = false;
    net_tick(1000 * MS); /* it goes out again, and is acknowledged again */
    HEARD("blue", "");
    CU_ASSERT_EQUAL(net.b[A]->pool.mails, 0);
    CU_ASSERT_EQUAL(net.b[B]->federation.count.repeated, 4);
}

/* B loses A for a while and A does not know: what is missing comes again before what follows. */
static void test_what_a_neighbour_did_not_hear(void)
{
    two();
    net_send("red", "blue", "one");
    net_settle();
    net_mute(A, true);
    net_send("red", "blue", "two");
    net_settle();
    net_mute(A, false);
    net_send("red", "blue", "three");
    HEARD("blue", "one");
    net_settle();
    net_tick(1000 * MS);
    HEARD("blue", "two; three");
    CU_ASSERT_EQUAL(net.repeats, 0);
    CU_ASSERT_EQUAL(net.b[A]->mailbox.posts_pool.live, 0);
    CU_ASSERT_TRUE(net.b[B]->gaps > 0);
}

/* One that was started often counts from far beyond its incarnation (disk_open.c). */
static void test_a_box_that_begins_says_where(void)
{
    net_begin();
    net.b[A]->mailbox.base = 1ull << 50;
    net_link(A, B, true);
    net_join("red", A);
    net_join("blue", B);
    net_settle();
    net_send("red", "blue", "one");
    net_settle();
    HEARD("blue", "one");
    CU_ASSERT_EQUAL(net.b[B]->gaps, 0);
}

/* What was said went to the reader of an earlier life, which the network took for alive. */
static void test_another_life_that_reads_is_told_all(void)
{
    two();
    net_send("red", "blue", "one");
    net_settle();
    remote_peer(net.b[B], "a")->boxes[registry_find(&net.b[B]->registry, "blue")].taken = 0;
    net_send("red", "blue", "two");
    net_settle();
    HEARD("blue", "one");
    broker_matched(net.b[A], "broker.b", false, net.now_ns);
    broker_matched(net.b[A], "broker.b", true, net.now_ns);
    net_settle();
    HEARD("blue", "two");
}

/* That it wants no broadcasts is known at the other brokers, too. */
static void test_who_wants_no_broadcasts(void)
{
    two();
    net_join("green", B);
    net_agent("blue")->no_broadcasts = true;
    net_register(net_agent("blue"), muster_STATE_RUNNING);
    net_settle();
    net_send("red", "all", "hello");
    net_send("red", "blue", "you");
    net_settle();
    HEARD("green", "hello");
    HEARD("blue", "you");
}

static void test_broadcasts_and_groups(void)
{
    two();
    net_join("green", B);
    net_settle();
    net_send("red", "all", "hello");
    net_settle();
    HEARD("blue", "hello");
    HEARD("green", "hello");
    net_ask("blue", "group-join", "team");
    net_ask("red", "group-join", "team");
    net_settle();
    net_send("red", "group:team", "us");
    net_settle();
    net_send("green", "group:team", "you");
    net_settle();
    HEARD("blue", "us; you");
    HEARD("red", "you");
    HEARD("green", "");
    net_ask("blue", "group-leave", "team");
    net_settle();
    net_send("red", "group:team", "nobody else");
    net_settle();
    HEARD("blue", "");
}

static void test_services(void)
{
    two();
    net_ask("blue", "advertise", "mapper role=scout");
    net_settle();
    net_ask("red", "find-service", "mapper");
    net_settle();
    CU_ASSERT_PTR_NOT_NULL(strstr(net_agent("red")->heard, "services mapper blue"));
    net_leave("blue");
    net_settle();
    net_agent("red")->heard[0] = '\0';
    net_ask("red", "find-service", "mapper");
    net_settle();
    CU_ASSERT_PTR_NULL(strstr(net_agent("red")->heard, "blue"));
}

static void test_groups_of_before_are_told_to_who_comes_later(void)
{
    net_begin();
    net_join("red", A);
    net_join("blue", B);
    net_settle();
    net_ask("red", "group-join", "team");
    net_ask("blue", "group-join", "team");
    net_settle();
    net_link(A, B, true);
    net_settle();
    net_send("red", "group:team", "us");
    net_settle();
    HEARD("blue", "us");
}

static void test_a_chain(void)
{
    chain();
    LIVES(A, "green", "c running");
    LIVES(C, "red", "a running");
    CU_ASSERT_EQUAL(net.b[A]->registry.agents[registry_find(&net.b[A]->registry, "green")].is.hops,
                    2);
    net_send("red", "green", "one");
    net_settle();
    HEARD("green", "one");
    TOLD("red", "1-1 stored; 1-1 stored; 1-1 delivered");
    net_send("green", "red", "two");
    net_settle();
    HEARD("red", "two");
    net_link(B, C, false);
    net_settle();
    LIVES(A, "green", "c absent");
    LIVES(C, "red", "a absent");
    net_send("red", "green", "three");
    net_settle();
    HEARD("green", "");
    net_tick(FEDERATION_PAUSE_MS * MS);
    net_link(B, C, true);
    net_settle();
    HEARD("green", "three");
}

static void test_the_shortest_way_and_another_one(void)
{
    triangle();
    uint32_t green = registry_find(&net.b[A]->registry, "green");
    CU_ASSERT_EQUAL(net.b[A]->registry.agents[green].is.hops, 1);
    CU_ASSERT_STRING_EQUAL(net.b[A]->registry.agents[green].place, "broker.c");
    net_send("red", "green", "one");
    net_settle();
    net_link(A, C, false);
    net_settle();
    net_send("red", "green", "two");
    net_tick(FEDERATION_PAUSE_MS * MS); /* what b knows may be an echo of what a has said */
    LIVES(A, "green", "c running");
    CU_ASSERT_EQUAL(net.b[A]->registry.agents[green].is.hops, 2);
    net_link(A, C, true);
    net_settle();
    CU_ASSERT_EQUAL(net.b[A]->registry.agents[green].is.hops, 1);
    net_send("red", "green", "three");
    net_settle();
    HEARD("green", "one; two; three");
    CU_ASSERT_EQUAL(net.repeats, 0);
}

static void test_who_has_gone_leaves_no_echo(void)
{
    triangle();
    net_link(A, C, false);
    net_link(B, C, false);
    net_settle();
    LIVES(A, "green", "c absent");
    LIVES(B, "green", "c absent");
    for (int i = 0; i < 20; i++) {
        net_tick(200 * MS);
        LIVES(A, "green", "c absent");
        LIVES(B, "green", "c absent");
    }
}

/* What was sent to where it lived, and is not acknowledged, goes to where it lives. */
static void test_an_agent_moves(void)
{
    triangle();
    net.deaf[A] = true;
    net_send("red", "green", "one");
    net_settle();
    HEARD("green", "one");
    net.deaf[A] = false;
    net_move("green", B);
    net_settle();
    LIVES(A, "green", "b running");
    LIVES(B, "green", "b running");
    LIVES(C, "green", "b running");
    HEARD("green", "");
    CU_ASSERT_EQUAL(net.repeats, 1);
    net_send("red", "green", "two");
    net_settle();
    HEARD("green", "two");
    net_move("green", A);
    net_settle();
    net_send("red", "green", "three");
    net_settle();
    HEARD("green", "three");
    LIVES(C, "green", "a running");
    CU_ASSERT_EQUAL(net.b[A]->pool.mails + net.b[B]->pool.mails + net.b[C]->pool.mails, 0);
    CU_ASSERT_EQUAL(net.b[A]->federation.count.clashes, 0);
}

static void test_mail_follows_to_another_broker(void)
{
    triangle();
    net_leave("green");
    net_settle();
    net_join("blue", C);
    net_send("blue", "green", "at c"); /* it waits there */
    net_send("red", "green", "at a");
    net_settle();
    net_join_as("green", "2", B, 9000);
    net_settle();
    READ(net.agents[3].heard, "at c; at a");
}

static void test_a_broker_dies_and_its_agents_go_to_another(void)
{
    two();
    net_ask("blue", "group-join", "team");
    net_send("red", "blue", "one");
    net_settle();
    HEARD("blue", "one");
    net_link(A, B, false);
    net_send("red", "blue", "two");
    net_settle();
    HEARD("blue", "");
    net_move("blue", A);
    net_settle();
    net_send("red", "group:team", "three");
    net_settle();
    HEARD("blue", "two; three");
    net_broker_open(B); /* it comes back, and knows nothing */
    net_link(A, B, true);
    net_settle();
    LIVES(B, "blue", "a running");
    net_join("green", B);
    net_settle();
    net_send("green", "group:team", "four");
    net_settle();
    HEARD("blue", "four");
}

static void test_a_restart_is_met_with_numbers_of_its_own(void)
{
    two();
    net_send("red", "blue", "one");
    net_settle();
    net_broker_open(B);
    net_link(A, B, true);
    net_move("blue", B);
    net_settle();
    net_send("red", "blue", "two");
    net_settle();
    net_send("blue", "red", "back");
    net_settle();
    HEARD("blue", "one; two");
    HEARD("red", "back");
}

static void test_what_a_sender_is_to_be_told_waits_for_the_link(void)
{
    two();
    broker_matched(net.b[B], "p-blue", false, net.now_ns); /* it reads nothing for now */
    net_send("red", "blue", "one");
    net_settle();
    TOLD("red", "1-1 stored");
    net_link(A, B, false);
    net_settle();
    broker_matched(net.b[B], "p-blue", true, net.now_ns);
    net_settle();
    HEARD("blue", "one");
    net_link(A, B, true);
    net_settle();
    TOLD("red", "1-1 delivered");
}

static void test_a_restart_that_nobody_noticed(void)
{
    two();
    net_ask("red", "group-join", "team");
    net_settle();
    net_broker_open(B); /* its old reader is still matched */
    net_hear_of(B, A, true);
    net_move("blue", B);
    net_settle();
    LIVES(A, "blue", "b running");
    LIVES(B, "red", "a running");
    net_send("blue", "group:team", "hello");
    net_settle();
    HEARD("red", "hello");
}

/* What B has had of A's earlier life says nothing of A's next one, of which B has not heard. */
static void test_what_is_acknowledged_to_an_earlier_life(void)
{
    two();
    net_send("red", "blue", "one");
    (void)net_deliver(A);
    net_broker_open(A);
    net_hear_of(A, B, true);
    net_move("red", A);
    announce_all(net.b[B]);
    (void)net_announce(B);
    net_match(A);
    net_send("red", "blue", "two");
    net.mute[A] = true;
    (void)net_deliver(A); /* the first of that box, too, and lost */
    net.mute[A] = false;
    (void)net_acknowledge(B);
    CU_ASSERT_EQUAL(net.b[A]->astray, 1);
    CU_ASSERT_EQUAL(net.b[A]->pool.mails, 1);
    net_settle();
    net_tick(1000 * MS);
    HEARD("blue", "one; two");
    CU_ASSERT_EQUAL(net.b[A]->pool.mails, 0);
}

static void test_a_name_that_both_sides_gave_away(void)
{
    for (int earlier = A; earlier <= B; earlier++) {
        net_begin();
        struct net_agent *first = net_join_as("red", "1", earlier, 100);
        struct net_agent *second = net_join_as("red", "2", B - earlier, 200);
        net_settle();
        net_link(A, B, true);
        net_settle();
        LIVES(A, "red", earlier == A ? "a running" : "b running");
        LIVES(B, "red", earlier == A ? "a running" : "b running");
        CU_ASSERT_STRING_EQUAL(first->refused, "");
        CU_ASSERT_STRING_EQUAL(second->refused, earlier == A ? "held by another participant at a"
                                                             : "held by another participant at b");
        CU_ASSERT_EQUAL(net.b[A]->federation.count.clashes + net.b[B]->federation.count.clashes, 1);
    }
}

static void test_a_name_that_is_held_elsewhere(void)
{
    two();
    struct net_agent *late = net_join_as("red", "2", B, 9000);
    net_tick(1000 * MS);
    CU_ASSERT_STRING_EQUAL(late->refused, "");
    net_tick(500 * MS);
    CU_ASSERT_STRING_EQUAL(late->refused, "held by another participant at a");
    LIVES(B, "red", "a running");
    net_register(late, muster_STATE_RUNNING);
    net_leave("red"); /* the first one */
    net_settle();
    LIVES(B, "red", "b running");
    LIVES(A, "red", "b running");
}

static void test_numbers_of_a_name_go_on_at_another_broker(void)
{
    two();
    net_send("red", "blue", "one");
    net_settle();
    net_leave("red");
    net_settle();
    uint32_t red = registry_find(&net.b[B]->registry, "red");
    CU_ASSERT_EQUAL(registry_last_seq(&net.b[B]->registry.agents[red]), 1);
    net_join("green", A);
    net_settle();
    net_link(A, B, false); /* it may have sent more that nobody has heard of */
    net_settle();
    uint32_t green = registry_find(&net.b[B]->registry, "green");
    CU_ASSERT_TRUE(registry_last_seq(&net.b[B]->registry.agents[green]) >= JOURNAL_RESERVE);
}

/* Sends in the name of white, as the command line does: it comes, sends one mail, and leaves. */
static void white_sends(const char *tag, int broker, const char *to, const char *content)
{
    struct net_agent *white = net_join_as("white", tag, broker, 9000 + net.now_ns);
    net_settle();
    muster_Mail m = letter("white", ++white->seq, to, content);
    net_up(white, &m, 0);
    net_settle();
    net_register(white, muster_STATE_ABSENT);
    white->at = -1;
    net_settle();
}

/* Before a link is cut, while it is, and after: nobody may take one mail for another. */
static void test_a_name_that_sends_on_both_sides_of_a_cut(void)
{
    two();
    white_sends("1", A, "red,blue", "before");
    net_link(A, B, false);
    net_tick(2000 * MS);
    white_sends("2", A, "red,blue", "left");
    white_sends("3", B, "red,blue", "right");
    net_link(A, B, true);
    net_tick(2000 * MS);
    net_settle();
    white_sends("4", A, "red,blue", "after");
    HEARD("red", "before; left; right; after");
    HEARD("blue", "before; right; left; after");
    CU_ASSERT_EQUAL(net.repeats, 0);
}

/* The same of one that was never there before. */
static void test_a_new_name_on_both_sides_of_a_cut(void)
{
    two();
    net_link(A, B, false);
    net_tick(2000 * MS);
    white_sends("1", A, "red,blue", "left");
    white_sends("2", B, "red,blue", "right");
    net_link(A, B, true);
    net_tick(2000 * MS);
    net_settle();
    HEARD("red", "left; right");
    HEARD("blue", "right; left");
}

static void test_numbers_of_one_broker_begin_at_one(void)
{
    net_begin();
    net_join("red", A);
    white_sends("1", A, "red", "one");
    white_sends("2", A, "red", "two");
    uint32_t white = registry_find(&net.b[A]->registry, "white");
    CU_ASSERT_EQUAL(registry_last_seq(&net.b[A]->registry.agents[white]), 2);
}

/* Whoever may be spoken for is said by the policy of his own broker, whichever one is asked. */
static void test_a_change_in_the_name_of_one_at_another_broker(void)
{
    struct mu_fault fault;
    chain();
    CU_ASSERT_EQUAL_FATAL(trust_read(&net.b[C]->trust, "allow red direct all", "c.policy", &fault),
                          MU_OK);
    net_join("blue", A);
    net_settle();
    net_ask("red", "group-join", "scouts green"); /* the default policy of A lets nobody */
    net_ask("blue", "group-join", "cooks green");
    net_settle();
    HEARD("red", "");
    CU_ASSERT_EQUAL(net.b[A]->unspoken, 0);
    CU_ASSERT_EQUAL(net.b[C]->unspoken, 1);
    CU_ASSERT_EQUAL(net.b[C]->directed, 1);
    for (int i = A; i <= C; i++) {
        CU_ASSERT_TRUE(groups_has(&net.b[i]->pages.groups, "scouts", "green", false));
        CU_ASSERT_FALSE(groups_has(&net.b[i]->pages.groups, "cooks", "green", false));
        CU_ASSERT_EQUAL(net.b[i]->pool.mails, 0);
    }
    net_ask("blue", "group-join", "cooks"); /* for himself he may */
    net_ask("blue", "group-join", "cooks blue");
    net_settle();
    CU_ASSERT_TRUE(groups_has(&net.b[C]->pages.groups, "cooks", "blue", false));
    CU_ASSERT_EQUAL(net.b[A]->unspoken, 0);
}

static muster_Delivery delivery_to_b(muster_Parcel *item)
{
    muster_Delivery d = {.process = words("broker.b"),
                         .broker = words("a"),
                         .broker_incarnation = net.incarnation[A],
                         .step = muster_STEP_NOW};
    d.parcels._buffer = item;
    d.parcels._length = d.parcels._maximum = 1;
    return d;
}

static void test_limit_hops(void)
{
    two();
    muster_Parcel p = {
        .box = words("blue"), .number = 1, .letter = letter("red", 1, "blue", "one")};
    muster_Delivery d = delivery_to_b(&p);
    p.letter.hops = MU_HOPS_MAX - 1;
    broker_delivery(net.b[B], &d, net.now_ns);
    net_settle();
    HEARD("blue", "one");
    p = (muster_Parcel){
        .box = words("blue"), .number = 2, .letter = letter("red", 2, "blue", "two")};
    p.letter.hops = MU_HOPS_MAX;
    broker_delivery(net.b[B], &d, net.now_ns);
    net_settle();
    HEARD("blue", "");
    TOLD("red", "1-1 delivered; 2-2 refused");
    CU_ASSERT_EQUAL(net.b[B]->federation.count.hops_refused, 1);
}

static void test_what_is_malformed_is_counted(void)
{
    two();
    uint64_t before = net.b[B]->counters.malformed;
    muster_Parcel p = {
        .box = words("broker"), .number = 1, .letter = letter("red", 1, "broker", "x")};
    muster_Delivery d = delivery_to_b(&p);
    broker_delivery(net.b[B], &d, net.now_ns);
    p.box = words("who is that");
    broker_delivery(net.b[B], &d, net.now_ns);
    p.box = words("blue");
    CU_ASSERT_TRUE(check_delivery(&d));
    p.letter.src = words("no name");
    CU_ASSERT_FALSE(check_delivery(&d));
    p.letter.src = words("red");
    p.letter.priority = 7;
    CU_ASSERT_FALSE(check_delivery(&d));
    p.letter.priority = 0;
    d.process = words("broker.c");
    broker_delivery(net.b[B], &d, net.now_ns);
    d.process = words("broker.b");
    d.broker = words("b");
    broker_delivery(net.b[B], &d, net.now_ns);
    CU_ASSERT_EQUAL(net.b[B]->counters.malformed, before + 4);
    d.broker = words("a");
    d.broker_incarnation--; /* of an earlier life: not heard at all */
    broker_delivery(net.b[B], &d, net.now_ns);
    CU_ASSERT_EQUAL(net.b[B]->counters.malformed, before + 4);
}

/* What a neighbour says of one agent, as the only one of that part. */
static void part_says(const char *neighbour, uint32_t part, const muster_Entry *entry)
{
    muster_Entry e = *entry;
    char process[MU_PROCESS_MAX + 1];
    snprintf(process, sizeof process, "broker.%s", neighbour);
    muster_Registration r = {.wire = muster_WIRE,
                             .process = process,
                             .part = part,
                             .broker = words(""),
                             .incarnation = 1,
                             .host = words("there"),
                             .is_broker = true};
    r.agents._buffer = &e;
    r.agents._length = r.agents._maximum = 1;
    broker_registration(net.b[A], &r, net.now_ns);
}

static void gamma_says(const char *neighbour, const muster_Entry *entry)
{
    part_says(neighbour, 0, entry);
}

static muster_Entry entry_of(const char *name, uint32_t hops)
{
    return (muster_Entry){.reason = words(""),
                          .name = words(name),
                          .state = muster_STATE_RUNNING,
                          .home = words("delta"),
                          .via = words(""),
                          .host = words("far"),
                          .hops = hops};
}

static void test_limit_distance(void)
{
    net_begin();
    muster_Entry near = entry_of("near", MU_DISTANCE_MAX - 1);
    muster_Entry far = entry_of("far", MU_DISTANCE_MAX);
    part_says("gamma", 0, &near);
    part_says("gamma", 1, &far);
    LIVES(A, "near", "delta running");
    CU_ASSERT_EQUAL(net.b[A]->registry.present, 1);
}

static void test_what_is_ours_is_no_news(void)
{
    net_begin();
    muster_Entry one = entry_of("one", 0), two = entry_of("two", 0),
                 three = entry_of("broker.x", 0);
    one.home = words("a");
    two.via = words("a");
    gamma_says("gamma", &one);
    gamma_says("gamma", &two);
    gamma_says("gamma", &three);
    CU_ASSERT_EQUAL(net.b[A]->registry.present, 0);
    CU_ASSERT_EQUAL(net.b[A]->counters.malformed, 1);
    LIVES(A, "broker.x", "nobody");
}

static void test_limit_brokers(void)
{
    char name[16];
    net_begin();
    muster_Entry e = entry_of("red", 0);
    for (int i = 0; i <= MU_BROKERS_MAX; i++) {
        snprintf(name, sizeof name, "n%d", i);
        gamma_says(name, &e);
    }
    CU_ASSERT_STRING_EQUAL(net.b[A]->federation.passed_over, name);
    gamma_says("more", &e);
    CU_ASSERT_STRING_EQUAL(net.b[A]->federation.passed_over, name); /* the first is told */
    CU_ASSERT_EQUAL(net.b[A]->federation.peers_count, MU_BROKERS_MAX);
    CU_ASSERT_EQUAL(net.b[A]->federation.peers_there, MU_BROKERS_MAX);
    broker_gone(net.b[A], "broker.n3", 0, true, net.now_ns); /* who is silent makes room */
    gamma_says(name, &e);
    CU_ASSERT_PTR_NOT_NULL(remote_peer(net.b[A], name));
    CU_ASSERT_PTR_NULL(remote_peer(net.b[A], "n3"));
}

static void test_only_what_has_changed_is_announced(void)
{
    char name[16];
    two();
    for (int i = 0; i < 100; i++) {
        snprintf(name, sizeof name, "x%d", i);
        muster_Entry e = entry_of(name, 0);
        gamma_says("gamma", &e);
    }
    net_settle();
    LIVES(B, "x99", "delta running");
    net.announcements = 0;
    net_settle();
    CU_ASSERT_EQUAL(net.announcements, 0);
    muster_Entry e = entry_of("x99", 0);
    e.state = muster_STATE_SUSPENDED;
    gamma_says("gamma", &e);
    net_settle();
    LIVES(B, "x99", "delta suspended");
    CU_ASSERT_EQUAL(net.announcements, 2); /* one part of a, and of b, who says it on */
}

static void test_a_lone_broker_announces_nothing(void)
{
    net_begin();
    net_join("red", A);
    net_settle();
    net_tick(1000 * MS);
    CU_ASSERT_EQUAL(net.announcements, 0);
    net_link(A, B, true);
    net_settle();
    net.announcements = 0;
    uint64_t counted = net.b[A]->federation.count.announced;
    net_tick(300 * MS);
    CU_ASSERT_EQUAL(net.announcements, 2); /* heartbeats */
    CU_ASSERT_EQUAL(net.b[A]->federation.count.announced, counted + 1);
}

int main(void)
{
    static CU_TestInfo tests[] = {
        {"agents are known everywhere", test_agents_are_known_everywhere},
        {"mail crosses", test_mail_crosses},
        {"mail waits for who is absent", test_mail_waits_for_who_is_absent},
        {"what is lost or comes twice", test_what_is_lost_or_comes_twice},
        {"who wants no broadcasts", test_who_wants_no_broadcasts},
        {"broadcasts and groups", test_broadcasts_and_groups},
        {"services", test_services},
        {"groups of before", test_groups_of_before_are_told_to_who_comes_later},
        {"a chain", test_a_chain},
        {"the shortest way", test_the_shortest_way_and_another_one},
        {"no echo", test_who_has_gone_leaves_no_echo},
        {"an agent moves", test_an_agent_moves},
        {"mail follows", test_mail_follows_to_another_broker},
        {"a broker dies", test_a_broker_dies_and_its_agents_go_to_another},
        {"a neighbour that did not hear", test_what_a_neighbour_did_not_hear},
        {"a box that begins", test_a_box_that_begins_says_where},
        {"another life that reads", test_another_life_that_reads_is_told_all},
        {"a restart", test_a_restart_is_met_with_numbers_of_its_own},
        {"receipts wait", test_what_a_sender_is_to_be_told_waits_for_the_link},
        {"a restart unnoticed", test_a_restart_that_nobody_noticed},
        {"what is acknowledged to an earlier life", test_what_is_acknowledged_to_an_earlier_life},
        {"a clash", test_a_name_that_both_sides_gave_away},
        {"a name held elsewhere", test_a_name_that_is_held_elsewhere},
        {"a name on both sides of a cut", test_a_name_that_sends_on_both_sides_of_a_cut},
        {"a new name on both sides", test_a_new_name_on_both_sides_of_a_cut},
        {"a change for one elsewhere", test_a_change_in_the_name_of_one_at_another_broker},
        {"numbers of one broker", test_numbers_of_one_broker_begin_at_one},
        {"numbers go on", test_numbers_of_a_name_go_on_at_another_broker},
        {"limit: hops", test_limit_hops},
        {"malformed", test_what_is_malformed_is_counted},
        {"limit: distance", test_limit_distance},
        {"what is ours", test_what_is_ours_is_no_news},
        {"limit: brokers", test_limit_brokers},
        {"a lookup", test_a_lookup_names_the_broker_at_which_an_agent_lives},
        {"changes alone", test_only_what_has_changed_is_announced},
        {"a lone broker", test_a_lone_broker_announces_nothing},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/federation", tests);
}
