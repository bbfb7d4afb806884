/* SPDX-License-Identifier: Apache-2.0 */
/* Which requests the page answers. */
#include "suite.h"
#include "web/web.h"

#include <CUnit/Basic.h>
#include <string.h>

static struct guard guard;

static const uint8_t bytes[GUARD_TOKEN_DIGITS / 2] = {0xab, 0x01, 0xff};
#define TOKEN "ab01ff00000000000000000000000000"

static struct guard_request look(void)
{
    return (struct guard_request){
        .method = "GET", .use = GUARD_LOOK, .host = "127.0.0.1:8642", .hosts = 1};
}

static struct guard_request act(void)
{
    struct guard_request r = look();
    r.method = "POST";
    r.use = GUARD_ACT;
    r.origin = "http://127.0.0.1:8642";
    r.site = "same-origin";
    r.token = TOKEN;
    return r;
}

static void judged(struct guard_request r, enum guard_verdict wanted)
{
    uint64_t before = guard.refused[wanted];
    CU_ASSERT_EQUAL(guard_judge(&guard, &r), wanted);
    CU_ASSERT_EQUAL(guard.refused[wanted], before + (wanted != GUARD_PASSED));
}

static void host_is(const char *host, enum guard_verdict wanted)
{
    struct guard_request r = look();
    r.host = host;
    judged(r, wanted);
}

static void origin_is(const char *origin, enum guard_verdict wanted)
{
    struct guard_request r = act();
    r.origin = origin;
    judged(r, wanted);
}

static void token_is(const char *token, enum guard_verdict wanted)
{
    struct guard_request r = act();
    r.token = token;
    judged(r, wanted);
}

static void test_token_is_made_of_all_bytes(void)
{
    guard_init(&guard, bytes, false);
    READS(guard.token, TOKEN);
}

static void test_hosts(void)
{
    guard_init(&guard, bytes, false);
    host_is("127.0.0.1:8642", GUARD_PASSED);
    host_is("localhost:9000", GUARD_PASSED); /* a tunnel's other end */
    host_is("localhost", GUARD_PASSED);
    host_is("127.0.0.1", GUARD_PASSED);
    host_is(NULL, GUARD_HOST);
    host_is("", GUARD_HOST);
    host_is("evil.example:8642", GUARD_HOST);
    host_is("localhost.evil.example", GUARD_HOST);
    host_is("localhost:", GUARD_HOST);
    host_is("localhost:80evil", GUARD_HOST);
    host_is("localhost:123456", GUARD_HOST);
    host_is("127.0.0.1.evil.example:8642", GUARD_HOST);
    host_is("127.0.0.10", GUARD_HOST);
    host_is("evil@127.0.0.1", GUARD_HOST);
}

static void test_one_host_only(void)
{
    guard_init(&guard, bytes, false);
    struct guard_request r = look();
    r.hosts = 2;
    judged(r, GUARD_HOST);
    r.hosts = 0;
    judged(r, GUARD_HOST);
}

static void test_origins(void)
{
    guard_init(&guard, bytes, false);
    origin_is("http://127.0.0.1:8642", GUARD_PASSED);
    origin_is(NULL, GUARD_PASSED); /* no browser, and it has the token */
    origin_is("null", GUARD_ORIGIN);
    origin_is("", GUARD_ORIGIN);
    origin_is("http://127.0.0.1:8643", GUARD_ORIGIN);
    origin_is("https://127.0.0.1:8642", GUARD_ORIGIN);
    origin_is("http://localhost:8642", GUARD_ORIGIN);
    origin_is("http://evil.example", GUARD_ORIGIN);
    origin_is("http://127.0.0.1:8642.evil.example", GUARD_ORIGIN);
}

static void test_other_sites_may_link_to_the_page_alone(void)
{
    guard_init(&guard, bytes, false);
    struct guard_request r = look();
    r.site = "cross-site";
    judged(r, GUARD_ORIGIN);
    r.is_entry = true;
    judged(r, GUARD_PASSED);
    r.site = "none";
    r.is_entry = false;
    judged(r, GUARD_PASSED);
    r = act();
    r.site = "same-site";
    r.is_entry = true;
    judged(r, GUARD_ORIGIN);
}

static void test_tokens(void)
{
    guard_init(&guard, bytes, false);
    token_is(TOKEN, GUARD_PASSED);
    token_is(NULL, GUARD_TOKEN);
    token_is("", GUARD_TOKEN);
    token_is("ab01ff0000000000000000000000000", GUARD_TOKEN);
    token_is(TOKEN "0", GUARD_TOKEN);
    token_is("bb01ff00000000000000000000000000", GUARD_TOKEN);
    token_is("ab01ff00000000000000000000000001", GUARD_TOKEN);
    token_is("AB01FF00000000000000000000000000", GUARD_TOKEN);
}

static void test_methods_and_paths(void)
{
    guard_init(&guard, bytes, false);
    struct guard_request r = look();
    r.method = "HEAD";
    judged(r, GUARD_PASSED);
    r.method = "POST";
    judged(r, GUARD_METHOD);
    r.method = "DELETE";
    judged(r, GUARD_METHOD);
    r = act();
    r.method = "GET";
    judged(r, GUARD_METHOD);
    r = look();
    r.use = GUARD_NOTHING;
    judged(r, GUARD_PATH);
    r.method = "TRACE";
    judged(r, GUARD_METHOD);
}

static void test_read_only_lets_nobody_act(void)
{
    guard_init(&guard, bytes, true);
    judged(act(), GUARD_READ_ONLY);
    judged(look(), GUARD_PASSED);
}

static void test_a_line_has_an_end(void)
{
    guard_init(&guard, bytes, false);
    struct guard_request r = act();
    r.body_bytes = GUARD_BODY_MAX;
    judged(r, GUARD_PASSED);
    r.body_bytes = GUARD_BODY_MAX + 1;
    judged(r, GUARD_SIZE);
}

static void test_each_verdict_has_a_status_and_words(void)
{
    for (int v = GUARD_PASSED + 1; v < GUARD_VERDICTS; v++) {
        CU_ASSERT_TRUE(guard_status((enum guard_verdict)v) >= 400);
        CU_ASSERT_TRUE(strlen(guard_text((enum guard_verdict)v)) > 10);
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the token is made of all bytes", test_token_is_made_of_all_bytes},
        {"hosts", test_hosts},
        {"one host only", test_one_host_only},
        {"origins", test_origins},
        {"other sites may link to the page alone", test_other_sites_may_link_to_the_page_alone},
        {"tokens", test_tokens},
        {"methods and paths", test_methods_and_paths},
        {"read-only lets nobody act", test_read_only_lets_nobody_act},
        {"a line has an end", test_a_line_has_an_end},
        {"each verdict has a status and words", test_each_verdict_has_a_status_and_words},
        CU_TEST_INFO_NULL,
    };
    return suite_run("web/guard", tests);
}
