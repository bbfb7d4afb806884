/* SPDX-License-Identifier: Apache-2.0 */
#include "samples.h"
#include "sim/record/record.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static struct run_hash *hash; /* static: leak checkers see its memory */

static int begin(void)
{
    hash = run_hash_open();
    return hash == NULL;
}

static muster_Mail mails[2];

/* An act with everything in it. */
static muster_Act act_make(void)
{
    mails[0] = (muster_Mail){.src = words("red"),
                             .dst = words("blue"),
                             .seq = 7,
                             .layer = 3,
                             .performative = words("tell"),
                             .content = words("near 2")};
    mails[1] = (muster_Mail){.src = words("red"),
                             .dst = words("all"),
                             .seq = 8,
                             .layer = 2,
                             .performative = words(""),
                             .content = words("")};
    muster_Act act = {.agent = words("red"),
                      .state = muster_STATE_RUNNING,
                      .drives = true,
                      .forward_m_s = 0.25,
                      .turn_rad_s = -0.5,
                      .firings = 2,
                      .rules = words("see act")};
    act.mails._buffer = mails;
    act.mails._length = act.mails._maximum = 2;
    return act;
}

static void text_of(const unsigned char digest[RUN_HASH_BYTES], char text[RUN_HASH_TEXT])
{
    for (size_t i = 0; i < RUN_HASH_BYTES; i++) {
        snprintf(text + 2 * i, 3, "%02x", digest[i]);
    }
}

/* Hashes of old runs depend on these: computed by another program from the order of the fields. */
static void test_hashes_stay_what_they_were(void)
{
    unsigned char digest[RUN_HASH_BYTES];
    char text[RUN_HASH_TEXT];
    muster_Act act = act_make();
    run_hash_act(hash, &act, digest);
    text_of(digest, text);
    CU_ASSERT_STRING_EQUAL(text, "a7768b63f7205c261bb118170bc81e5f"
                                 "dfe3481d8a8df12d094a3b26c41acccb");
    run_hash_outside(hash, mails, 2, digest);
    text_of(digest, text);
    CU_ASSERT_STRING_EQUAL(text, "75645f83193b3d146554f33a0ce98c4e"
                                 "aac191dc93bf836b762a7c31ff8bbead");

    struct run_hash *run = run_hash_open();
    run_hash_fold_number(run, 0x0102030405060708);
    run_hash_fold(run, "abc", 3);
    run_hash_end(run, text);
    CU_ASSERT_STRING_EQUAL(text, "a95f9b6766a7808b67c164180904f51e"
                                 "22562775f5307c9c323725f53b9a50ca");
}

/* FIPS 180-2, B.1, and the digest of nothing. */
static void test_it_is_sha256(void)
{
    char text[RUN_HASH_TEXT];
    struct run_hash *nothing = run_hash_open();
    run_hash_end(nothing, text);
    CU_ASSERT_STRING_EQUAL(text, "e3b0c44298fc1c149afbf4c8996fb924"
                                 "27ae41e4649b934ca495991b7852b855");
    struct run_hash *abc = run_hash_open();
    run_hash_fold(abc, "abc", 3);
    run_hash_end(abc, text);
    CU_ASSERT_STRING_EQUAL(text, "ba7816bf8f01cfea414140de5dae2223"
                                 "b00361a396177a9cb410ff61f20015ad");
}

enum change_field {
    AGENT,
    STATE,
    DRIVES,
    FORWARD,
    TURN,
    PADDLES,
    LIFT,
    FIRINGS,
    RULES,
    MAILS, /* of the act */
    SRC,
    DST,
    SEQ,
    LAYER,
    PERFORMATIVE,
    CONTENT, /* of its first mail */
};

/* Each way to change an act, in one field or in two. */
static const struct change {
    struct {
        enum change_field field;
        const char *text;
        double number;
    } fields[2];
} changes[] = {
    {{{AGENT, "reda", 0}}},
    {{{STATE, NULL, muster_STATE_SUSPENDED}}},
    {{{DRIVES, NULL, 0}}},
    {{{FORWARD, NULL, 0.25000000000000006}}}, /* by one bit */
    {{{FORWARD, NULL, 0.0}}},
    {{{FORWARD, NULL, -0.0}}},
    {{{TURN, NULL, 0.5}}},
    {{{PADDLES, NULL, 1}}},
    {{{PADDLES, NULL, -1}}},
    {{{LIFT, NULL, 1}}},
    {{{LIFT, NULL, -1}}},
    {{{PADDLES, NULL, 1}, {LIFT, NULL, -1}}},
    {{{PADDLES, NULL, -1}, {LIFT, NULL, 1}}},
    {{{FIRINGS, NULL, 3}}},
    {{{RULES, "act see", 0}}},
    {{{MAILS, NULL, 1}}},
    {{{MAILS, NULL, 0}}},
    {{{SRC, "rex", 0}}},
    {{{DST, "all", 0}}},
    {{{SEQ, NULL, 9}}},
    {{{LAYER, NULL, 1}}},
    {{{PERFORMATIVE, "ask", 0}}},
    {{{CONTENT, "near 3", 0}}},
    {{{CONTENT, "near 2 ", 0}}},
    /* Bytes that move over the border between two fields. */
    {{{RULES, "see actred", 0}, {SRC, "", 0}}},
    {{{SRC, "redblue", 0}, {DST, "", 0}}},
    {{{PERFORMATIVE, "", 0}, {CONTENT, "tellnear 2", 0}}},
    {{{PERFORMATIVE, "tel", 0}, {CONTENT, "lnear 2", 0}}},
    /* Fields that change places. */
    {{{FORWARD, NULL, -0.5}, {TURN, NULL, 0.25}}},
    {{{SEQ, NULL, 3}, {LAYER, NULL, 7}}},
    {{{SRC, "blue", 0}, {DST, "red", 0}}},
};
enum { CHANGES = sizeof changes / sizeof changes[0] };

static void change_field(muster_Act *act, enum change_field field, const char *text, double number)
{
    switch (field) {
    case AGENT: act->agent = words(text); break;
    case STATE: act->state = (muster_State)number; break;
    case DRIVES: act->drives = number > 0; break;
    case FORWARD: act->forward_m_s = number; break;
    case TURN: act->turn_rad_s = number; break;
    case PADDLES: act->paddles = (int32_t)number; break;
    case LIFT: act->lift = (int32_t)number; break;
    case FIRINGS: act->firings = (uint32_t)number; break;
    case RULES: act->rules = words(text); break;
    case MAILS: act->mails._length = (uint32_t)number; break;
    case SRC: mails[0].src = words(text); break;
    case DST: mails[0].dst = words(text); break;
    case SEQ: mails[0].seq = (uint64_t)number; break;
    case LAYER: mails[0].layer = (uint32_t)number; break;
    case PERFORMATIVE: mails[0].performative = words(text); break;
    case CONTENT: mails[0].content = words(text); break;
    }
}

static void change(muster_Act *act, const struct change *c)
{
    for (size_t i = 0; i < 2; i++) {
        /* The second one may be missing: AGENT without a text. */
        if (c->fields[i].field != AGENT || c->fields[i].text) {
            change_field(act, c->fields[i].field, c->fields[i].text, c->fields[i].number);
        }
    }
}

static void test_each_change_shows(void)
{
    unsigned char digests[CHANGES + 1][RUN_HASH_BYTES];
    for (int i = 0; i <= CHANGES; i++) {
        unsigned char again[RUN_HASH_BYTES];
        muster_Act act = act_make();
        if (i < CHANGES) { /* the last is the act as it is */
            change(&act, &changes[i]);
        }
        run_hash_act(hash, &act, digests[i]);
        run_hash_act(hash, &act, again);
        CU_ASSERT_EQUAL(memcmp(again, digests[i], RUN_HASH_BYTES), 0);
        for (int k = 0; k < i; k++) {
            CU_ASSERT_NOT_EQUAL(memcmp(digests[k], digests[i], RUN_HASH_BYTES), 0);
        }
    }
}

/* The hash of a run of these two acts, in this order. */
static void run_of(muster_Act *first, muster_Act *second, char text[RUN_HASH_TEXT])
{
    struct run_hash *run = run_hash_open();
    unsigned char digest[RUN_HASH_BYTES];
    run_hash_act(run, first, digest);
    run_hash_fold(run, digest, sizeof digest);
    run_hash_act(run, second, digest);
    run_hash_fold(run, digest, sizeof digest);
    run_hash_end(run, text);
}

static void test_the_order_of_a_run_matters(void)
{
    char there[RUN_HASH_TEXT];
    char back[RUN_HASH_TEXT];
    char again[RUN_HASH_TEXT];
    muster_Act red = act_make();
    muster_Act blue = red;
    blue.agent = words("blue");
    run_of(&red, &blue, there);
    run_of(&blue, &red, back);
    run_of(&red, &blue, again);
    CU_ASSERT_STRING_EQUAL(there, again);
    CU_ASSERT_STRING_NOT_EQUAL(there, back);
    CU_ASSERT_EQUAL(strlen(there), RUN_HASH_TEXT - 1);
    CU_ASSERT_EQUAL(strspn(there, "0123456789abcdef"), RUN_HASH_TEXT - 1);
}

/* Digests of acts are made whenever answers arrive: they leave no trace in the run. */
static void test_when_an_act_is_digested_does_not_matter(void)
{
    char one[RUN_HASH_TEXT];
    char other[RUN_HASH_TEXT];
    unsigned char red_digest[RUN_HASH_BYTES];
    unsigned char outside[RUN_HASH_BYTES];
    muster_Act red = act_make();
    run_of(&red, &red, one);
    struct run_hash *run = run_hash_open();
    run_hash_act(run, &red, red_digest);
    run_hash_outside(run, mails, 2, outside);
    run_hash_fold(run, red_digest, sizeof red_digest);
    run_hash_outside(run, mails, 1, outside);
    run_hash_fold(run, red_digest, sizeof red_digest);
    run_hash_end(run, other);
    CU_ASSERT_STRING_EQUAL(one, other);
}

static void test_mails_from_outside(void)
{
    unsigned char none[RUN_HASH_BYTES];
    unsigned char one[RUN_HASH_BYTES];
    unsigned char two[RUN_HASH_BYTES];
    unsigned char swapped[RUN_HASH_BYTES];
    (void)act_make();
    run_hash_outside(hash, NULL, 0, none);
    run_hash_outside(hash, mails, 1, one);
    run_hash_outside(hash, mails, 2, two);
    muster_Mail turned[2] = {mails[1], mails[0]};
    run_hash_outside(hash, turned, 2, swapped);
    CU_ASSERT_NOT_EQUAL(memcmp(none, one, RUN_HASH_BYTES), 0);
    CU_ASSERT_NOT_EQUAL(memcmp(one, two, RUN_HASH_BYTES), 0);
    CU_ASSERT_NOT_EQUAL(memcmp(two, swapped, RUN_HASH_BYTES), 0);
}

/* The hash of a run of one order. */
static void order_hash(const muster_RunCommand *order, char text[RUN_HASH_TEXT])
{
    struct run_hash *run = run_hash_open();
    run_hash_order(run, order);
    run_hash_end(run, text);
}

static void test_an_order_is_what_it_does(void)
{
    muster_RunCommand base = {.source = words("a"), .name = words("red"), .file = words("")};
    muster_RunCommand changed[14];
    char texts[14][RUN_HASH_TEXT], same[RUN_HASH_TEXT];
    for (size_t i = 0; i < 14; i++) {
        changed[i] = base;
    }
    changed[1].order = muster_RUN_PLACE;
    changed[2].name = words("blue");
    double *const numbers[] = {&changed[3].x_m,         &changed[4].y_m,
                               &changed[5].heading_rad, &changed[6].force_x_n,
                               &changed[7].force_y_n,   &changed[8].torque_nm,
                               &changed[9].time_s};
    for (size_t i = 0; i < 7; i++) {
        *numbers[i] = 0.5;
    }
    changed[10].keeps_heading = true;
    changed[11].senses = 2;
    changed[12].on = true;
    changed[13].x_m = -0.0;
    for (size_t i = 0; i < 14; i++) {
        order_hash(&changed[i], texts[i]);
        for (size_t k = 0; k < i; k++) {
            CU_ASSERT_STRING_NOT_EQUAL(texts[k], texts[i]);
        }
    }
    base.source = words("b"); /* who said it, and as which of its orders, changes nothing */
    base.seq = 7;
    order_hash(&base, same);
    CU_ASSERT_STRING_EQUAL(same, texts[0]);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"it is SHA-256", test_it_is_sha256},
        {"hashes stay what they were", test_hashes_stay_what_they_were},
        {"each change shows", test_each_change_shows},
        {"the order of a run matters", test_the_order_of_a_run_matters},
        {"when an act is digested does not matter", test_when_an_act_is_digested_does_not_matter},
        {"mails from outside", test_mails_from_outside},
        {"an order is what it does", test_an_order_is_what_it_does},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"sim/run_hash", begin, NULL, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
