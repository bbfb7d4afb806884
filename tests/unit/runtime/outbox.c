/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/outbox.h"
#include "core/random.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static struct outbox box; /* static: leak checkers see its memory */
enum { TEXT_BYTES = MU_OUTBOX_MAX * OUTBOX_TEXT_EACH };

static struct outbox_slot slots[MU_OUTBOX_MAX];
static char room[TEXT_BYTES];
static muster_Mail out[MU_OUTBOX_MAX];

static void set_up(void)
{
    outbox_init(&box, MU_OUTBOX_MAX, slots, room, 7000);
    alarm(30); /* a loop without end is a failure too */
}

static void tear_down(void)
{
    alarm(0);
}

static mu_result put(const char *content)
{
    return outbox_put(&box, "red", &(struct mu_mail){.dst = "blue", .content = content});
}

static void put_numbered(unsigned count)
{
    for (unsigned i = 1; i <= count; i++) {
        char content[16];
        snprintf(content, sizeof content, "m%u", i);
        CU_ASSERT_EQUAL_FATAL(put(content), MU_OK);
    }
}

/* Checks that what waits to go out bears numbers from first_seq on, and "m1", "m2", ... */
static void expect_waiting(uint64_t first_seq, unsigned first_content, unsigned count)
{
    CU_ASSERT_EQUAL_FATAL(outbox_unsent(&box, out, MU_OUTBOX_MAX), count);
    for (unsigned i = 0; i < count; i++) {
        char content[16];
        snprintf(content, sizeof content, "m%u", first_content + i);
        CU_ASSERT_EQUAL_FATAL(out[i].seq, first_seq + i);
        CU_ASSERT_STRING_EQUAL_FATAL(out[i].content, content);
    }
}

static void test_a_mail_is_copied_whole(void)
{
    char content[] = "hello";
    const struct mu_mail mail = {.src = "somebody-else",
                                 .dst = "blue,green",
                                 .seq = 77,
                                 .number = 5,
                                 .layer = MU_LAYER_QUERY,
                                 .performative = "ask-one",
                                 .language = "json",
                                 .ontology = "o",
                                 .reply_with = "r1",
                                 .in_reply_to = "q1",
                                 .conversation = "c1",
                                 .content = content,
                                 .ttl_ns = 9};
    CU_ASSERT_EQUAL(outbox_put(&box, "red", &mail), MU_OK);
    memset(content, 'x', sizeof content - 1);
    CU_ASSERT_EQUAL_FATAL(outbox_unsent(&box, out, 1), 1);
    CU_ASSERT_STRING_EQUAL(out[0].src, "red");
    CU_ASSERT_STRING_EQUAL(out[0].dst, "blue,green");
    CU_ASSERT_EQUAL(out[0].seq, 1);
    CU_ASSERT_EQUAL(out[0].layer, MU_LAYER_QUERY);
    CU_ASSERT_STRING_EQUAL(out[0].performative, "ask-one");
    CU_ASSERT_STRING_EQUAL(out[0].language, "json");
    CU_ASSERT_STRING_EQUAL(out[0].ontology, "o");
    CU_ASSERT_STRING_EQUAL(out[0].reply_with, "r1");
    CU_ASSERT_STRING_EQUAL(out[0].in_reply_to, "q1");
    CU_ASSERT_STRING_EQUAL(out[0].conversation, "c1");
    CU_ASSERT_STRING_EQUAL(out[0].content, "hello");
    CU_ASSERT_EQUAL(out[0].due_ns, -1);
    CU_ASSERT_EQUAL(out[0].ttl_ns, 9);
}

static void test_null_strings_become_empty(void)
{
    CU_ASSERT_EQUAL(outbox_put(&box, "red", &(struct mu_mail){.dst = "all"}), MU_OK);
    CU_ASSERT_EQUAL_FATAL(outbox_unsent(&box, out, 1), 1);
    const char *const texts[] = {out[0].performative, out[0].language,    out[0].ontology,
                                 out[0].reply_with,   out[0].in_reply_to, out[0].conversation,
                                 out[0].content};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        CU_ASSERT_STRING_EQUAL(texts[i], "");
    }
}

static void test_going_out_in_order(void)
{
    CU_ASSERT_EQUAL(outbox_unsent(&box, out, MU_OUTBOX_MAX), 0);
    put_numbered(5);
    expect_waiting(1, 1, 5);
    CU_ASSERT_EQUAL(outbox_unsent(&box, out, 2), 2);
    CU_ASSERT_EQUAL(outbox_unsent(&box, out, 0), 0);
    outbox_sent(&box, 2);
    expect_waiting(3, 3, 3);
    outbox_sent(&box, 0);
    outbox_sent(&box, 3);
    expect_waiting(6, 6, 0);
    CU_ASSERT_EQUAL(box.first_seq, 1);
}

static void test_again(void)
{
    put_numbered(5);
    outbox_sent(&box, 4);
    outbox_confirm(&box, 1, 2);
    expect_waiting(5, 5, 1);
    outbox_again(&box);
    expect_waiting(3, 3, 3);
    outbox_sent(&box, 3);
    outbox_again(&box);
    expect_waiting(3, 3, 3);
    outbox_confirm(&box, 3, 5);
    outbox_again(&box);
    expect_waiting(6, 6, 0);
}

/* The broker has it, and may die before it answers. */
static void test_what_was_had_is_kept_for_the_next_broker(void)
{
    put_numbered(3);
    outbox_sent(&box, 3);
    for (int i = 1; i < OUTBOX_HAD; i++) {
        outbox_had(&box, 1, 2);
    }
    CU_ASSERT_EQUAL(box.first_seq, 1);
    outbox_to_other(&box);
    expect_waiting(1, 1, 3);
    outbox_sent(&box, 3);
    for (int i = 1; i < OUTBOX_HAD; i++) {
        outbox_had(&box, 0, UINT64_MAX);
    }
    CU_ASSERT_EQUAL(box.first_seq, 1);
    outbox_confirm(&box, 2, 2);
    outbox_had(&box, 1, 1);
    CU_ASSERT_EQUAL(box.first_seq, 3);
    outbox_had(&box, 3, 3);
    CU_ASSERT_EQUAL(box.first_seq, 4);
    outbox_had(&box, 1, 3); /* too late */
    expect_waiting(4, 4, 0);
}

static void test_what_was_out_says_so_when_it_goes_again(void)
{
    put_numbered(4);
    outbox_sent(&box, 2);
    outbox_again(&box);
    outbox_sent(&box, 1);
    outbox_again(&box); /* the second one has been out, too */
    CU_ASSERT_EQUAL_FATAL(outbox_unsent(&box, out, MU_OUTBOX_MAX), 4);
    CU_ASSERT_TRUE(out[0].again && out[1].again);
    CU_ASSERT_FALSE(out[2].again || out[3].again);
    CU_ASSERT_EQUAL(box.own_seq, 1);
}

/* What was said of it stands: another broker is not to deliver what was refused, or once more. */
static void test_what_is_over_is_a_number_to_the_next_broker(void)
{
    put_numbered(4);
    outbox_sent(&box, 4);
    outbox_end(&box, 2, 2);
    outbox_confirm(&box, 3, 3); /* it waits there, and may be lost with the broker */
    outbox_again(&box);
    CU_ASSERT_EQUAL_FATAL(outbox_unsent(&box, out, MU_OUTBOX_MAX), 4);
    CU_ASSERT_STRING_EQUAL(out[1].content, "m2");
    outbox_to_other(&box);
    CU_ASSERT_EQUAL_FATAL(outbox_unsent(&box, out, MU_OUTBOX_MAX), 4);
    for (uint64_t i = 0; i < 4; i++) {
        CU_ASSERT_EQUAL(out[i].seq, i + 1);
        CU_ASSERT_TRUE(out[i].again);
        CU_ASSERT_STRING_EQUAL(out[i].src, "red");
        CU_ASSERT_EQUAL(out[i].dst[0] == '\0', i == 1);
    }
    CU_ASSERT_STRING_EQUAL(out[1].content, "");
    CU_ASSERT_STRING_EQUAL(out[2].content, "m3");
    outbox_sent(&box, 4);
    outbox_confirm(&box, 1, 1);
    CU_ASSERT_EQUAL(box.first_seq, 4);
}

static void test_confirmed_out_of_order(void)
{
    put_numbered(6);
    outbox_sent(&box, 6);
    outbox_confirm(&box, 3, 4);
    CU_ASSERT_EQUAL(box.first_seq, 1);
    outbox_confirm(&box, 2, 2);
    CU_ASSERT_EQUAL(box.first_seq, 1);
    outbox_confirm(&box, 1, 1);
    CU_ASSERT_EQUAL(box.first_seq, 5);
    outbox_confirm(&box, 1, 4); /* again, and too late */
    CU_ASSERT_EQUAL(box.first_seq, 5);
    outbox_confirm(&box, 6, 5); /* nothing */
    CU_ASSERT_EQUAL(box.first_seq, 5);
    outbox_again(&box);
    expect_waiting(5, 5, 2);
    outbox_confirm(&box, 6, UINT64_MAX);
    CU_ASSERT_EQUAL(box.first_seq, 5);
    outbox_confirm(&box, 0, UINT64_MAX);
    CU_ASSERT_EQUAL(box.first_seq, 7);
    CU_ASSERT_EQUAL(box.next_seq, 7);
    expect_waiting(7, 7, 0);
    CU_ASSERT_EQUAL(put("m7"), MU_OK);
    expect_waiting(7, 7, 1);
}

/* A name that has sent before goes on counting, however many mails wait already. */
static void test_continue_numbers_what_waits(void)
{
    static const uint64_t lasts[] = {1,    2,    3,    4,    5,    6,    1019,     1020,      1021,
                                     1022, 1023, 1024, 1025, 2047, 2048, 1u << 20, 1ull << 40};
    for (size_t i = 0; i < sizeof lasts / sizeof lasts[0]; i++) {
        outbox_init(&box, MU_OUTBOX_MAX, slots, room, 7000);
        put_numbered(5);
        outbox_continue(&box, lasts[i]);
        outbox_confirm(&box, 1, lasts[i]); /* as the runtime does next */
        expect_waiting(lasts[i] + 1, 1, 5);
        CU_ASSERT_EQUAL(put("m6"), MU_OK);
        outbox_continue(&box, lasts[i]); /* said again */
        expect_waiting(lasts[i] + 1, 1, 6);
        outbox_sent(&box, 6);
        outbox_confirm(&box, lasts[i] + 2, lasts[i] + 6);
        outbox_again(&box);
        CU_ASSERT_EQUAL(box.first_seq, lasts[i] + 1);
        outbox_confirm(&box, lasts[i] + 1, lasts[i] + 1);
        CU_ASSERT_EQUAL(box.first_seq, box.next_seq);
    }
}

static void test_continue_with_a_full_box(void)
{
    put_numbered(MU_OUTBOX_MAX);
    outbox_continue(&box, 500);
    expect_waiting(501, 1, MU_OUTBOX_MAX);
    CU_ASSERT_EQUAL(put("x"), MU_FULL);
    outbox_sent(&box, 10);
    outbox_confirm(&box, 501, 510);
    CU_ASSERT_EQUAL(put("m1025"), MU_OK);
    expect_waiting(511, 11, MU_OUTBOX_MAX - 9);
}

static void test_continue_of_an_empty_box(void)
{
    outbox_continue(&box, 41);
    outbox_continue(&box, 41);
    CU_ASSERT_EQUAL(put("m1"), MU_OK);
    expect_waiting(42, 1, 1);
    outbox_continue(&box, 7); /* less than we know */
    expect_waiting(42, 1, 1);
}

static void test_a_rewound_box_gives_the_last_numbers_again(void)
{
    outbox_continue(&box, 41);
    outbox_rewind(&box, 2);
    put_numbered(2);
    expect_waiting(40, 1, 2);
    outbox_rewind(&box, 1); /* it is not empty any more */
    expect_waiting(40, 1, 2);
    outbox_sent(&box, 2);
    outbox_confirm(&box, 40, 41);
    outbox_rewind(&box, 1); /* they were said again */
    CU_ASSERT_EQUAL(put("m3"), MU_OK);
    expect_waiting(42, 3, 1);
}

static void test_a_box_is_not_rewound_behind_its_first_number(void)
{
    outbox_continue(&box, 1);
    outbox_rewind(&box, 2);
    CU_ASSERT_EQUAL(put("m1"), MU_OK);
    expect_waiting(2, 1, 1);
}

static void test_continue_leaves_what_went_out(void)
{
    put_numbered(4);
    outbox_sent(&box, 2);
    outbox_continue(&box, 1);
    outbox_continue(&box, 3);
    outbox_continue(&box, 90);
    outbox_again(&box);
    expect_waiting(1, 1, 4);
    outbox_continue(&box, 3); /* another broker has had some of them: they keep their numbers */
    expect_waiting(1, 1, 4);
    outbox_confirm(&box, 1, 3);
    expect_waiting(4, 4, 1);
    outbox_continue(&box, 0); /* a broker that knows nothing */
    expect_waiting(4, 4, 1);
}

static char *long_text(size_t bytes)
{
    static char text[MU_CONTENT_MAX + 2];
    memset(text, 't', sizeof text - 1);
    return text + sizeof text - 1 - bytes;
}

static void test_limit_fields(void)
{
    static const struct {
        size_t offset, max;
    } fields[] = {
        {offsetof(struct mu_mail, dst), MU_DST_MAX},
        {offsetof(struct mu_mail, performative), MU_FIELD_MAX},
        {offsetof(struct mu_mail, language), MU_FIELD_MAX},
        {offsetof(struct mu_mail, ontology), MU_FIELD_MAX},
        {offsetof(struct mu_mail, reply_with), MU_FIELD_MAX},
        {offsetof(struct mu_mail, in_reply_to), MU_FIELD_MAX},
        {offsetof(struct mu_mail, conversation), MU_FIELD_MAX},
        {offsetof(struct mu_mail, content), MU_CONTENT_MAX},
    };
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        struct mu_mail mail = {.dst = "blue"};
        const char **at = (const char **)(void *)((char *)&mail + fields[i].offset);
        *at = long_text(fields[i].max);
        CU_ASSERT_EQUAL(outbox_put(&box, "red", &mail), MU_OK);
        CU_ASSERT_EQUAL(box.next_seq, i + 2);
        *at = long_text(fields[i].max + 1);
        CU_ASSERT_EQUAL(outbox_put(&box, "red", &mail), MU_MALFORMED);
        CU_ASSERT_EQUAL(box.next_seq, i + 2);
    }
    CU_ASSERT_EQUAL(outbox_put(&box, "red", &(struct mu_mail){.dst = ""}), MU_MALFORMED);
    CU_ASSERT_EQUAL(outbox_put(&box, "red", &(struct mu_mail){.content = "x"}), MU_MALFORMED);
    CU_ASSERT_EQUAL(outbox_put(&box, long_text(MU_NAME_MAX + 1), &(struct mu_mail){.dst = "b"}),
                    MU_MALFORMED);
}

static void test_limit_mails(void)
{
    put_numbered(MU_OUTBOX_MAX);
    CU_ASSERT_EQUAL(put("one too many"), MU_FULL);
    CU_ASSERT_EQUAL(put("one too many"), MU_FULL);
    outbox_sent(&box, MU_OUTBOX_MAX);
    outbox_confirm(&box, 2, 2);
    CU_ASSERT_EQUAL(put("still"), MU_FULL); /* the first has no answer yet */
    outbox_confirm(&box, 1, 1);
    CU_ASSERT_EQUAL(put("m1025"), MU_OK);
    CU_ASSERT_EQUAL(put("m1026"), MU_OK);
    CU_ASSERT_EQUAL(put("m1027"), MU_FULL);
    expect_waiting(MU_OUTBOX_MAX + 1, MU_OUTBOX_MAX + 1, 2);
}

static void test_limit_text(void)
{
    unsigned count = 0;
    while (put(long_text(MU_CONTENT_MAX)) == MU_OK) {
        count++;
    }
    CU_ASSERT_EQUAL(count, TEXT_BYTES / (MU_CONTENT_MAX + 18));
    CU_ASSERT_EQUAL(put(long_text(MU_CONTENT_MAX)), MU_FULL);
    CU_ASSERT_EQUAL(box.next_seq, count + 1);
    CU_ASSERT_EQUAL(put("a small one"), MU_OK);
    outbox_confirm(&box, 1, 2);
    CU_ASSERT_EQUAL(put(long_text(MU_CONTENT_MAX)), MU_OK);
    outbox_confirm(&box, 1, UINT64_MAX);
    for (unsigned i = 0; i < count; i++) { /* empty: all of it is free again */
        CU_ASSERT_EQUAL(put(long_text(MU_CONTENT_MAX)), MU_OK);
    }
}

/* A mail to blue takes 16 bytes beside its content; one byte of the ring always stays free. */
static void test_limit_text_to_the_byte(void)
{
    enum { PART = 16 * 1024, PARTS = TEXT_BYTES / PART };
    for (int i = 0; i < PARTS - 1; i++) {
        CU_ASSERT_EQUAL(put(long_text(PART - 16)), MU_OK);
    }
    CU_ASSERT_EQUAL(put(long_text(PART - 16)), MU_FULL);
    outbox_confirm(&box, 1, 1);
    CU_ASSERT_EQUAL(put(long_text(PART - 16)), MU_FULL);
    outbox_confirm(&box, 2, 2);
    CU_ASSERT_EQUAL(put(long_text(PART - 16)), MU_OK); /* in the place of the first */
    CU_ASSERT_EQUAL(put(long_text(PART - 16)), MU_FULL);
    CU_ASSERT_EQUAL(put(long_text(PART - 17)), MU_OK); /* all but a byte of the second's */
    CU_ASSERT_EQUAL(put(""), MU_FULL);
    CU_ASSERT_EQUAL_FATAL(outbox_unsent(&box, out, MU_OUTBOX_MAX), PARTS - 1);
    for (int i = 0; i < PARTS - 1; i++) {
        CU_ASSERT_EQUAL(strlen(out[i].content), i < PARTS - 2 ? PART - 16 : PART - 17);
        CU_ASSERT_STRING_EQUAL(out[i].src, "red");
    }
}

/* --- a random life against a plain list ------------------------------------------------------ */

enum { MODEL_SEED = 11, MODEL_ROUNDS = 24000, MODEL_MAILS = 2 * MU_OUTBOX_MAX, HEAD_BYTES = 40 };

static struct {
    uint64_t first, next, unsent; /* seq */
    size_t len[MODEL_MAILS];      /* of the content, by seq */
    bool confirmed[MODEL_MAILS];
    unsigned full_by_count, full_by_text, wraps;
} model;

static void model_content(uint64_t seq, size_t len, char *content)
{
    memset(content, (int)('a' + seq % 26), len);
    content[len] = '\0';
}

static size_t model_bytes(void)
{
    size_t bytes = 0;
    for (uint64_t seq = model.first; seq < model.next; seq++) {
        bytes += model.len[seq % MODEL_MAILS];
    }
    return bytes;
}

static void model_put(struct mu_random *r, bool long_mails)
{
    static char content[MU_CONTENT_MAX + 1];
    char dst[32];
    size_t len = (size_t)mu_random_between(r, 0, long_mails ? MU_CONTENT_MAX : 60);
    size_t head = box.text_head;
    model_content(model.next, len, content);
    snprintf(dst, sizeof dst, "d%llu", (unsigned long long)model.next);
    mu_result got = outbox_put(&box, "red", &(struct mu_mail){.dst = dst, .content = content});
    if (got == MU_OK) {
        model.len[model.next % MODEL_MAILS] = len;
        model.confirmed[model.next % MODEL_MAILS] = false;
        model.wraps += box.text_head < head && box.text_tail > 0;
        model.next++;
        CU_ASSERT_FATAL(model.next - model.first <= MU_OUTBOX_MAX);
    } else if (model.next - model.first == MU_OUTBOX_MAX) {
        model.full_by_count++;
        CU_ASSERT_EQUAL_FATAL(got, MU_FULL);
    } else {
        /* Neither the piece before nor the piece after what is used had room for it. */
        model.full_by_text++;
        CU_ASSERT_EQUAL_FATAL(got, MU_FULL);
        CU_ASSERT_FATAL(model_bytes() + 2 * (MU_CONTENT_MAX + HEAD_BYTES) +
                            HEAD_BYTES * (model.next - model.first) >
                        TEXT_BYTES);
    }
}

static void model_confirm(struct mu_random *r)
{
    uint64_t first = model.first + (uint64_t)mu_random_between(r, -3, 12);
    uint64_t last = first + (uint64_t)mu_random_between(r, 0, 20);
    if (model.first < 3) {
        return;
    }
    for (uint64_t seq = first; seq <= last; seq++) {
        if (seq >= model.first && seq < model.next) {
            model.confirmed[seq % MODEL_MAILS] = true;
        }
    }
    while (model.first < model.next && model.confirmed[model.first % MODEL_MAILS]) {
        model.first++;
    }
    model.unsent = model.unsent < model.first ? model.first : model.unsent;
    outbox_confirm(&box, first, last);
}

static void model_send(struct mu_random *r)
{
    uint32_t most = (uint32_t)mu_random_between(r, 0, 30);
    uint64_t waiting = model.next - model.unsent;
    uint32_t count = outbox_unsent(&box, out, most);
    CU_ASSERT_EQUAL_FATAL(count, waiting < most ? waiting : most);
    outbox_sent(&box, count);
    model.unsent += count;
}

/* Reads back every mail that is kept. */
static void model_compare(void)
{
    static char content[MU_CONTENT_MAX + 1];
    struct outbox copy = box;
    CU_ASSERT_EQUAL_FATAL(box.first_seq, model.first);
    CU_ASSERT_EQUAL_FATAL(box.next_seq, model.next);
    CU_ASSERT_EQUAL_FATAL(box.unsent_seq, model.unsent);
    outbox_again(&copy);
    uint32_t count = outbox_unsent(&copy, out, MU_OUTBOX_MAX);
    CU_ASSERT_EQUAL_FATAL(count, model.next - model.first);
    for (uint32_t i = 0; i < count; i++) {
        uint64_t seq = model.first + i;
        char dst[32];
        snprintf(dst, sizeof dst, "d%llu", (unsigned long long)seq);
        model_content(seq, model.len[seq % MODEL_MAILS], content);
        CU_ASSERT_FATAL(out[i].seq == seq && strcmp(out[i].src, "red") == 0 &&
                        strcmp(out[i].dst, dst) == 0 && strcmp(out[i].content, content) == 0);
    }
}

static void test_random_against_a_model(void)
{
    struct mu_random r;
    mu_random_seed(&r, MODEL_SEED, "outbox");
    outbox_continue(&box, 900); /* slots and text wrap at different places */
    memset(&model, 0, sizeof model);
    model.first = model.next = model.unsent = 901;
    printf("seed %d ", MODEL_SEED);
    for (int round = 0; round < MODEL_ROUNDS; round++) {
        bool long_mails = round / 4000 % 2 == 0;
        bool filling = round / (long_mails ? 100 : 2000) % 2 == 0;
        switch (mu_random_between(&r, 0, 49)) {
        case 0: model_confirm(&r); break;
        case 1:
            outbox_again(&box);
            model.unsent = model.first;
            break;
        case 2: model_send(&r); break;
        case 3: outbox_continue(&box, model.next - 1); break;
        default:
            if (filling || mu_random_between(&r, 0, 2) == 0) {
                model_put(&r, long_mails);
            } else {
                model_confirm(&r);
            }
        }
        if (round % 40 == 0) {
            model_compare();
        }
    }
    model_compare();
    CU_ASSERT(model.full_by_count > 10 && model.full_by_text > 10 && model.wraps > 10);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a mail is copied whole", test_a_mail_is_copied_whole},
        {"NULL strings become empty", test_null_strings_become_empty},
        {"going out in order", test_going_out_in_order},
        {"again", test_again},
        {"what was had is kept for the next broker", test_what_was_had_is_kept_for_the_next_broker},
        {"what is over is a number to the next broker",
         test_what_is_over_is_a_number_to_the_next_broker},
        {"what was out says so", test_what_was_out_says_so_when_it_goes_again},
        {"confirmed out of order", test_confirmed_out_of_order},
        {"continue numbers what waits", test_continue_numbers_what_waits},
        {"continue with a full box", test_continue_with_a_full_box},
        {"a rewound box gives the last numbers again",
         test_a_rewound_box_gives_the_last_numbers_again},
        {"a box is not rewound behind its first number",
         test_a_box_is_not_rewound_behind_its_first_number},
        {"continue of an empty box", test_continue_of_an_empty_box},
        {"continue leaves what went out", test_continue_leaves_what_went_out},
        {"limit: fields", test_limit_fields},
        {"limit: mails", test_limit_mails},
        {"limit: text", test_limit_text},
        {"limit: text, to the byte", test_limit_text_to_the_byte},
        {"random against a model", test_random_against_a_model},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"runtime/outbox", NULL, NULL, set_up, tear_down, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
