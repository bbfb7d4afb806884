/* SPDX-License-Identifier: Apache-2.0 */
/* Handlers of layers, events and refusals from C: their limits, and what a robot has without them.
 */
#include "mind/mind.h"
#include "muster/limits.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>

enum { HANDLERS = 32, REFUSED = 64, TEXT = 65536 };

static char posted[MU_CONTENT_MAX + MU_DST_MAX + 64];
static char changed[MU_FIELD_MAX + MU_ATTRIBUTES_MAX + 64];
static char text[TEXT];

static mu_result post(void *self, const struct mind_letter *letter)
{
    (void)self;
    snprintf(posted, sizeof posted, "%s: %s", letter->dst, letter->content);
    return MU_OK;
}

static mu_result change(void *self, enum mind_change what, const char *name, const char *attributes,
                        uint64_t lease_ns)
{
    (void)self;
    (void)lease_ns;
    snprintf(changed, sizeof changed, "%d %s %s", (int)what, name, attributes);
    return MU_OK;
}

static struct mind *open_mind(void)
{
    static struct mind *all[16]; /* a mind's memory is for the life of the process */
    static size_t count;
    struct mu_fault fault;
    struct mind_options options = {
        .name = "blue", .seed = 1, .ports = {.send = post, .change = change}};
    CU_ASSERT_FATAL(count < sizeof all / sizeof all[0]);
    CU_ASSERT_EQUAL_FATAL(mind_open(&all[count], &options, &fault), MU_OK);
    return all[count++];
}

static mu_result say(struct mind *m, const char *line)
{
    struct mu_text out;
    mu_text_init(&out, text, sizeof text);
    return mind_line(m, line, &out);
}

static struct mind_mail mail_in(uint32_t layer, const char *performative)
{
    return (struct mind_mail){.id = 1,
                              .src = "red",
                              .performative = performative,
                              .language = "",
                              .ontology = "",
                              .reply_with = "q",
                              .in_reply_to = "",
                              .conversation = "",
                              .content = "a 1",
                              .layer = layer};
}

static void test_no_handler(void)
{
    struct mind *m = open_mind();
    struct mind_mail mail = mail_in(MU_LAYER_SPEECH, "tell");
    CU_ASSERT(!mind_has_layer(m, MU_LAYER_SPEECH));
    CU_ASSERT(!mind_handle(m, &mail));
    CU_ASSERT(mind_understands(m, &mail));
    mail.layer = 0; /* layer 3 */
    CU_ASSERT(mind_understands(m, &mail));
    mail.performative = "haggle";
    CU_ASSERT(!mind_understands(m, &mail));
    mail.in_reply_to = "q-1";
    CU_ASSERT(mind_understands(m, &mail));
    mail = mail_in(MU_LAYER_SPEECH, "");
    CU_ASSERT(mind_understands(m, &mail));
    for (uint32_t layer = 1; layer < 6; layer++) {
        mail = mail_in(layer, "cfp");
        CU_ASSERT_EQUAL(mind_understands(m, &mail), layer == MU_LAYER_SPEECH);
        mail.performative = "inform";
        mail.in_reply_to = "q-1";
        CU_ASSERT(mind_understands(m, &mail));
    }
    mind_close(m);
}

static void test_limit_handlers(void)
{
    char line[128];
    struct mind *m = open_mind();
    for (int i = 0; i <= HANDLERS; i++) {
        snprintf(line, sizeof line, "(deffunction h%d (?id ?from ?p ?c) (send red %d) FALSE)", i,
                 i);
        CU_ASSERT_EQUAL(say(m, line), MU_OK);
        snprintf(line, sizeof line, "(on-layer %d h%d)", 4 + i % 2, i);
        CU_ASSERT_EQUAL(say(m, line), i < HANDLERS ? MU_OK : MU_MALFORMED);
    }
    CU_ASSERT_STRING_EQUAL(text,
                           "[MUSTER1] Function on-layer expected at most 32 handlers\nFALSE\n");
    CU_ASSERT_EQUAL(say(m, "(on-layer 5 h3)"), MU_OK); /* it is there already */
    struct mind_mail mail = mail_in(5, "cfp");
    CU_ASSERT(!mind_handle(m, &mail));
    CU_ASSERT_STRING_EQUAL(posted, "red: 1"); /* the oldest of the layer is asked last */
    mind_close(m);
}

/* What a handler took from a mail stays whole after many other mails. */
static void test_handled_content_stays(void)
{
    struct mind *m = open_mind();
    CU_ASSERT_EQUAL(say(m, "(defglobal ?*kept* = nil)"), MU_OK);
    CU_ASSERT_EQUAL(say(m,
                        "(deffunction keep (?id ?from ?p ?c) (if (= ?id 1) then (bind ?*kept* ?c) "
                        "(assert (kept ?c))))"),
                    MU_OK);
    CU_ASSERT_EQUAL(say(m, "(on-layer 4 keep)"), MU_OK);
    struct mind_mail mail = mail_in(4, "cfp");
    CU_ASSERT(!mind_handle(m, &(struct mind_mail){.id = 1,
                                                  .src = "red",
                                                  .performative = "",
                                                  .language = "",
                                                  .content = "other layer",
                                                  .layer = 5}));
    CU_ASSERT(mind_handle(m, &mail));
    char content[32];
    for (uint64_t id = 2; id < 2000; id++) {
        snprintf(content, sizeof content, "b %d", (int)id);
        mail.id = id;
        mail.content = content;
        CU_ASSERT(!mind_handle(m, &mail)); /* (if) without else is FALSE */
    }
    CU_ASSERT_EQUAL(say(m, "(create$ ?*kept* (length$ (findall (kept a 1))))"), MU_OK);
    CU_ASSERT_STRING_EQUAL(text, "(a 1 1)\n");
    mind_close(m);
}

/* A mind without a resolver, one with more names than fit, and one that is gone. */
static void test_resolver(void)
{
    char small[8];
    struct mind *m = open_mind();
    struct mu_text names = mu_text_in(small, sizeof small);
    CU_ASSERT_STRING_EQUAL(mind_scheme(m), "");
    CU_ASSERT(!mind_resolve(m, "low", "red", &names));
    CU_ASSERT_EQUAL(say(m, "(deffunction all (?rest ?sender) (create$ red green blue))"), MU_OK);
    CU_ASSERT_EQUAL(say(m, "(on-resolve busy all)"), MU_OK);
    CU_ASSERT_STRING_EQUAL(mind_scheme(m), "busy");
    snprintf(small, sizeof small, "%d busy", (int)MIND_RESOLVE);
    CU_ASSERT_EQUAL(strncmp(changed, small, strlen(small)), 0);
    names = mu_text_in(small, sizeof small);
    CU_ASSERT(mind_resolve(m, "low", "red", &names));
    CU_ASSERT(names.cut);
    CU_ASSERT_EQUAL(say(m, "(undeffunction all)"), MU_OK);
    CU_ASSERT(!mind_resolve(m, "low", "red", &names));
    mind_close(m);
}

static void test_limit_refusals(void)
{
    char what[64];
    struct mind *m = open_mind();
    for (int i = 0; i < 2 * REFUSED; i++) {
        snprintf(what, sizeof what, "group-leave g%d", i);
        mind_refused(m, what, "unknown-group");
    }
    CU_ASSERT_EQUAL(say(m, "(length$ (findall (event refused group-leave ? unknown-group)))"),
                    MU_OK);
    CU_ASSERT_STRING_EQUAL(text, "64\n");
    CU_ASSERT_EQUAL(say(m, "(length$ (findall (event refused group-leave g127 ?)))"), MU_OK);
    CU_ASSERT_STRING_EQUAL(text, "1\n");
    mind_close(m);
}

static void test_facts_are_cut(void)
{
    char small[64];
    struct mu_text out;
    struct mind *m = open_mind();
    CU_ASSERT_EQUAL(say(m, "(loop-for-count (?i 1 100) do (assert (n ?i)))"), MU_OK);
    mu_text_init(&out, text, sizeof text);
    CU_ASSERT_EQUAL(mind_facts(m, "n", &out), MU_OK);
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "(n 100)\nFor a total of 100 facts.\n"));
    mu_text_init(&out, small, sizeof small);
    CU_ASSERT_EQUAL(mind_facts(m, "n", &out), MU_OK);
    CU_ASSERT(out.cut && out.len == sizeof small - 1);
    mu_text_init(&out, small, sizeof small);
    CU_ASSERT_EQUAL(say(m, "(assert (greek \u03b1\u03b2\u03b3\u03b4))"), MU_OK);
    for (size_t size = 18; size < 26; size++) { /* wherever the cut is, these stay in pairs */
        size_t high = 0;
        mu_text_init(&out, small, size);
        CU_ASSERT_EQUAL(mind_facts(m, "greek", &out), MU_OK);
        for (const char *c = small; *c; c++) {
            high += (unsigned char)*c >= 0x80;
        }
        CU_ASSERT(out.cut && strlen(small) == out.len && high % 2 == 0);
    }
    mu_text_init(&out, small, sizeof small);
    CU_ASSERT_EQUAL(mind_facts(m, "nothing", &out), MU_ABSENT);
    CU_ASSERT_STRING_EQUAL(small, "no facts nothing\n");
    mind_close(m);
}

/* The longest list of receivers, and the longest attributes, and one byte more. */
static void test_limit_words(void)
{
    static char line[4096];
    struct mind *m = open_mind();
    for (int more = 0; more < 2; more++) {
        struct mu_text t;
        mu_text_init(&t, line, sizeof line);
        mu_text_add(&t, "(send (create$");
        for (int i = 0; i < MU_DST_MAX / 32; i++) { /* 31 names of 31 bytes and their commas */
            mu_text_format(&t, " n%030d", i);
        }
        mu_text_format(&t, " n%0*d) x)", 30 + more, 99); /* and one that fills the rest */
        CU_ASSERT_EQUAL(say(m, line), more ? MU_MALFORMED : MU_OK);
    }
    CU_ASSERT_EQUAL(strlen(posted), MU_DST_MAX + strlen(": x"));
    for (int more = 0; more < 2; more++) {
        struct mu_text t;
        mu_text_init(&t, line, sizeof line);
        mu_text_add(&t, "(advertise map");
        for (int i = 0; i < 3; i++) { /* 63 bytes each, and a blank */
            mu_text_format(&t, " k%d a%059d", i, 1);
        }
        mu_text_format(&t, " k3 a%0*d)", 59 + more, 1);
        CU_ASSERT_EQUAL(say(m, line), more ? MU_MALFORMED : MU_OK);
    }
    mind_close(m);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"without a handler", test_no_handler},
        {"limit: handlers", test_limit_handlers},
        {"what a handler was given stays", test_handled_content_stays},
        {"a resolver of addresses", test_resolver},
        {"limit: refused changes", test_limit_refusals},
        {"facts are cut", test_facts_are_cut},
        {"limit: receivers and attributes", test_limit_words},
        CU_TEST_INFO_NULL,
    };
    return suite_run("mind/layers", tests);
}
