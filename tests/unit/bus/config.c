/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/config.h"
#include "muster/limits.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>

static char xml[4096];

static void write_for(enum bus_place place, int index, const char *interface, const char *hub)
{
    struct bus_options options = {
        .domain = 3, .place = place, .name = "test", .interface = interface, .hub = hub};
    struct mu_text text;
    mu_text_init(&text, xml, sizeof xml);
    config_write(&text, &options, index);
    CU_ASSERT_FALSE_FATAL(text.cut);
}

static bool has(const char *piece)
{
    return strstr(xml, piece) != NULL;
}

static unsigned times(const char *piece)
{
    unsigned count = 0;
    for (const char *at = xml; (at = strstr(at, piece)) != NULL; at += strlen(piece)) {
        count++;
    }
    return count;
}

/* As much of XML as there is in it: tags that nest, attributes in double quotes.
 * @return whether every tag is closed by its own name */
static bool well_formed(void)
{
    char open[16][40];
    size_t depth = 0;
    const char *at = xml;
    bool rooted = false;
    while ((at = strchr(at, '<')) != NULL) {
        const char *end = strchr(at, '>');
        bool closes = at[1] == '/';
        const char *name = at + 1 + closes;
        size_t len = strcspn(name, " />");
        if (!end || len == 0 || len >= sizeof open[0] || depth == 16) {
            return false;
        }
        if (depth == 0 && (rooted || closes)) {
            return false;
        }
        if (closes) {
            depth--;
            if (strlen(open[depth]) != len || strncmp(open[depth], name, len) != 0) {
                return false;
            }
        } else if (end[-1] != '/') {
            snprintf(open[depth++], sizeof open[0], "%.*s", (int)len, name);
        }
        rooted = true;
        at = end;
    }
    return rooted && depth == 0 && xml[strlen(xml) - 1] == '>' && times("\"") % 2 == 0;
}

static void test_ports(void)
{
    /* RTPS 2.2, 9.6.1.1: 7400 + 250 domain + 10 + 2 index */
    CU_ASSERT_EQUAL(bus_port(0, 0), 7410);
    CU_ASSERT_EQUAL(bus_port(0, 1), 7412);
    CU_ASSERT_EQUAL(bus_port(3, 0), 8160);
    CU_ASSERT_EQUAL(bus_port(99, 119), 32398);
    CU_ASSERT(bus_port(230, CONFIG_INDEX_LAST) <= 65535);
}

static void test_places_of_the_star(void)
{
    static const struct {
        enum bus_place place;
        int index;
    } places[] = {{BUS_BROKER, 0},
                  {BUS_BROKER, 4},
                  {BUS_SIMULATOR, CONFIG_INDEX_SIMULATOR},
                  {BUS_AGENT, CONFIG_INDEX_FIRST},
                  {BUS_AGENT, CONFIG_INDEX_LAST}};
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        char index[64];
        write_for(places[i].place, places[i].index, NULL, NULL);
        snprintf(index, sizeof index, "<ParticipantIndex>%d</ParticipantIndex>", places[i].index);
        CU_ASSERT_TRUE(well_formed());
        CU_ASSERT_TRUE(has(index));
        CU_ASSERT_EQUAL(times("<ParticipantIndex>"), 1);
        CU_ASSERT_TRUE(has("<NetworkInterface address=\"127.0.0.1\"/>"));
        CU_ASSERT_EQUAL(times("<NetworkInterface "), 1);
        CU_ASSERT_TRUE(has("<AllowMulticast>false</AllowMulticast>"));
        CU_ASSERT_EQUAL(times("<Peers>"), 1);
        if (places[i].place != BUS_AGENT) { /* on its own host a hub calls on everyone */
            CU_ASSERT_TRUE(has("<Peer address=\"127.0.0.1\"/>"));
            CU_ASSERT_EQUAL(times("<Peer "), 1);
            continue;
        }
        CU_ASSERT_TRUE(has("<Peer address=\"127.0.0.1:8160\"/>"));
        CU_ASSERT_TRUE(has("<Peer address=\"127.0.0.1:8162\"/>"));
        CU_ASSERT_TRUE(has("<Peer address=\"127.0.0.1:8164\"/>"));
        CU_ASSERT_TRUE(has("<Peer address=\"127.0.0.1:8166\"/>"));
        CU_ASSERT_TRUE(has("<Peer address=\"127.0.0.1:8168\"/>"));
        CU_ASSERT_EQUAL(times("<Peer "), 5);
    }
}

static void test_observer_peers_with_everybody(void)
{
    write_for(BUS_OBSERVER, CONFIG_INDEX_FIRST + 1, NULL, NULL);
    CU_ASSERT_TRUE(well_formed());
    CU_ASSERT_TRUE(has("<Peer address=\"127.0.0.1\"/>"));
    CU_ASSERT_EQUAL(times("<Peer "), 1);
    CU_ASSERT_TRUE(has("<MaxAutoParticipantIndex>119</MaxAutoParticipantIndex>"));
    CU_ASSERT_TRUE(has("<ParticipantIndex>11</ParticipantIndex>"));
}

static void test_interface_and_hub(void)
{
    write_for(BUS_AGENT, CONFIG_INDEX_FIRST, "10.0.0.7", NULL);
    CU_ASSERT_TRUE(well_formed());
    CU_ASSERT_TRUE(has("<NetworkInterface address=\"10.0.0.7\"/>"));
    CU_ASSERT_TRUE(has("<Peer address=\"10.0.0.7:8160\"/>"));
    CU_ASSERT_FALSE(has("127.0.0.1"));

    write_for(BUS_AGENT, CONFIG_INDEX_FIRST, "10.0.0.7", "hub.local");
    CU_ASSERT_TRUE(has("<NetworkInterface address=\"10.0.0.7\"/>"));
    CU_ASSERT_TRUE(has("<Peer address=\"hub.local:8160\"/>"));
    CU_ASSERT_TRUE(has("<Peer address=\"hub.local:8162\"/>"));
    CU_ASSERT_FALSE(has("Peer address=\"10.0.0.7"));

    write_for(BUS_OBSERVER, CONFIG_INDEX_FIRST, NULL, "hub.local");
    CU_ASSERT_TRUE(has("<Peer address=\"hub.local\"/>"));
}

/* A large packet is for loopback alone: a network would cut it. */
static void test_large_packets_stay_on_loopback(void)
{
    static const char *const sizes[] = {"<MaxMessageSize>", "<MaxRexmitMessageSize>",
                                        "<FragmentSize>"};
    static const char *const elsewhere[] = {"10.0.0.7", "192.168.127.1", "12.7.0.1"};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        write_for(BUS_BROKER, 0, NULL, NULL);
        CU_ASSERT_EQUAL(times(sizes[i]), 1);
        write_for(BUS_AGENT, CONFIG_INDEX_FIRST, "127.0.1.1", NULL);
        CU_ASSERT_EQUAL(times(sizes[i]), 1);
        for (size_t k = 0; k < sizeof elsewhere / sizeof elsewhere[0]; k++) {
            write_for(BUS_AGENT, CONFIG_INDEX_FIRST, elsewhere[k], NULL);
            CU_ASSERT_TRUE(well_formed());
            CU_ASSERT_FALSE(has(sizes[i]));
        }
    }
}

static void test_what_is_loopback(void)
{
    CU_ASSERT_TRUE(config_is_loopback(NULL));
    CU_ASSERT_TRUE(config_is_loopback("127.0.0.1"));
    CU_ASSERT_TRUE(config_is_loopback("127.3.2.1"));
    CU_ASSERT_FALSE(config_is_loopback("12.7.0.1"));
    CU_ASSERT_FALSE(config_is_loopback("192.168.127.1"));
}

static void test_indices_of_the_places(void)
{
    static const int brokers[] = {0, 2, 3, 4, -1};
    for (int i = 0; i < 5; i++) {
        CU_ASSERT_EQUAL(config_index(BUS_BROKER, i), brokers[i]);
    }
    CU_ASSERT_EQUAL(config_index(BUS_SIMULATOR, 0), 1);
    CU_ASSERT_EQUAL(config_index(BUS_SIMULATOR, 1), -1);
    CU_ASSERT_EQUAL(config_index(BUS_AGENT, 0), 10);
    CU_ASSERT_EQUAL(config_index(BUS_AGENT, 108), 118);
    CU_ASSERT_EQUAL(config_index(BUS_AGENT, 109), -1);
    CU_ASSERT_EQUAL(config_index(BUS_OBSERVER, 110), -1);
}

static void test_several_hosts(void)
{
    write_for(BUS_AGENT, CONFIG_INDEX_FIRST, NULL, "10.0.0.1,far.example");
    CU_ASSERT_TRUE(well_formed());
    CU_ASSERT_EQUAL(times("<Peer address=\"10.0.0.1:"), 5);
    CU_ASSERT_EQUAL(times("<Peer address=\"far.example:"), 5);
    CU_ASSERT_EQUAL(times("<Peer "), 10);

    /* A broker peers with the others of its own host, too, and once. */
    write_for(BUS_BROKER, 2, "10.0.0.7", "10.0.0.1");
    CU_ASSERT_EQUAL(times("<Peer address=\"10.0.0.1:"), 5);
    CU_ASSERT_EQUAL(times("<Peer address=\"10.0.0.7\"/>"), 1);
    CU_ASSERT_EQUAL(times("<Peer "), 6);
    write_for(BUS_BROKER, 2, "10.0.0.7", "10.0.0.1,10.0.0.7");
    CU_ASSERT_EQUAL(times("<Peer address=\"10.0.0.7\"/>"), 1);
    CU_ASSERT_EQUAL(times("<Peer "), 6);
    write_for(BUS_SIMULATOR, 1, "10.0.0.7", "10.0.0.1");
    CU_ASSERT_EQUAL(times("<Peer address=\"10.0.0.7\"/>"), 1);
    CU_ASSERT_EQUAL(times("<Peer "), 6);
}

/* A process that may have to look for its hub says often that it is there. On loopback, where
 * little is lost, writers ask behind longer pauses what has arrived. */
static void test_intervals(void)
{
    static const struct {
        enum bus_place place;
        const char *interface, *hub, *presence, *heartbeat;
    } cases[] = {{BUS_AGENT, NULL, NULL, "1s", "\"20ms\">50ms"},
                 {BUS_AGENT, "10.0.0.7", NULL, "1s", "\"20ms\">20ms"},
                 {BUS_AGENT, NULL, "far.example", "200ms", "\"20ms\">50ms"},
                 {BUS_OBSERVER, NULL, NULL, "200ms", "\"20ms\">50ms"},
                 {BUS_SIMULATOR, NULL, NULL, "8s", "\"20ms\">50ms"},
                 {BUS_SIMULATOR, NULL, "far.example", "200ms", "\"20ms\">50ms"},
                 {BUS_BROKER, NULL, NULL, "8s", "\"50ms\">50ms"},
                 {BUS_BROKER, NULL, "far.example", "2s", "\"50ms\">50ms"},
                 {BUS_BROKER, "10.0.0.7", NULL, "2s", "\"20ms\">10ms"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char presence[64], heartbeat[64];
        write_for(cases[i].place, 10, cases[i].interface, cases[i].hub);
        snprintf(presence, sizeof presence, "<SPDPInterval>%s<", cases[i].presence);
        snprintf(heartbeat, sizeof heartbeat, "minsched=%s</HeartbeatInterval>",
                 cases[i].heartbeat);
        CU_ASSERT_TRUE(has(presence));
        CU_ASSERT_TRUE(has(heartbeat));
    }
}

/* What a broker keeps for a process on its host is little, unless it floods it. */
static void test_watermarks(void)
{
    static const struct {
        enum bus_place place;
        const char *interface, *piece;
    } cases[] = {
        {BUS_BROKER, NULL, "<WhcHighInit>16kB</WhcHighInit><WhcHigh>2MB</WhcHigh>"},
        {BUS_BROKER, NULL, "<WhcLow>8kB</WhcLow>"},
        {BUS_BROKER, NULL, "<WhcAdaptive>true<"},
        {BUS_BROKER, "10.0.0.7", "<WhcHighInit>512kB</WhcHighInit><WhcHigh>512kB</WhcHigh>"},
        {BUS_BROKER, "10.0.0.7", "<WhcAdaptive>false<"},
        {BUS_AGENT, NULL, "<WhcHighInit>8MB</WhcHighInit><WhcHigh>8MB</WhcHigh>"},
        {BUS_SIMULATOR, NULL, "<WhcAdaptive>false<"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_for(cases[i].place, 10, cases[i].interface, NULL);
        CU_ASSERT_TRUE(has(cases[i].piece));
    }
}

static void append(char *hosts)
{
    size_t len = strlen(hosts);
    memcpy(hosts + len, ",h", 3);
}

static void test_limit_hosts(void)
{
    char hosts[512] = "h";
    for (int i = 1; i < MU_PEERS_MAX; i++) {
        append(hosts);
    }
    CU_ASSERT_TRUE(config_hosts_valid(hosts));
    append(hosts);
    CU_ASSERT_FALSE(config_hosts_valid(hosts));
    static const char *const wrong[] = {"", ",", "a,", ",a", "a,,b", "a b", "a\"b", "<a>", "a,b&"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        CU_ASSERT_FALSE(config_hosts_valid(wrong[i]));
    }
    char longest[300];
    memset(longest, 'a', sizeof longest);
    longest[255] = '\0';
    CU_ASSERT_TRUE(config_hosts_valid(longest));
    longest[255] = 'a';
    longest[256] = '\0';
    CU_ASSERT_FALSE(config_hosts_valid(longest));
}

/* The buffer that bus.c has holds the longest configuration there is. */
static void test_limit_the_longest_configuration(void)
{
    static char hosts[MU_PEERS_MAX * 256];
    memset(hosts, 'a', sizeof hosts);
    for (size_t i = 255; i < sizeof hosts; i += 256) {
        hosts[i] = ',';
    }
    hosts[sizeof hosts - 1] = '\0';
    CU_ASSERT_TRUE(config_hosts_valid(hosts));
    struct bus_options options = {.domain = 230, .place = BUS_BROKER, .hub = hosts};
    static char buffer[CONFIG_XML_MAX];
    struct mu_text text;
    mu_text_init(&text, buffer, sizeof buffer);
    config_write(&text, &options, 4);
    CU_ASSERT_FALSE(text.cut);
}

static void test_limit_a_text_too_small_is_cut(void)
{
    struct bus_options options = {.place = BUS_AGENT};
    char small[64];
    struct mu_text text;
    mu_text_init(&text, small, sizeof small);
    config_write(&text, &options, CONFIG_INDEX_FIRST);
    CU_ASSERT_TRUE(text.cut);
    CU_ASSERT_EQUAL(strlen(small), sizeof small - 1);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"ports", test_ports},
        {"places of the star", test_places_of_the_star},
        {"an observer peers with everybody", test_observer_peers_with_everybody},
        {"interface and hub", test_interface_and_hub},
        {"large packets stay on loopback", test_large_packets_stay_on_loopback},
        {"indices of the places", test_indices_of_the_places},
        {"what is loopback", test_what_is_loopback},
        {"several hosts", test_several_hosts},
        {"intervals", test_intervals},
        {"watermarks", test_watermarks},
        {"limit: hosts", test_limit_hosts},
        {"limit: the longest configuration", test_limit_the_longest_configuration},
        {"limit: a text too small", test_limit_a_text_too_small_is_cut},
        CU_TEST_INFO_NULL,
    };
    return suite_run("bus/config", tests);
}
