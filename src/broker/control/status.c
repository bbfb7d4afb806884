/* SPDX-License-Identifier: Apache-2.0 */
/* What there is to see of a broker: its counters, its pages, its audit, its alerts. */
#include "broker/control/parts.h"

void broker_status(const struct broker *b, muster_BrokerStatus *status)
{
    *status = b->counters;
    status->waiting = b->mailbox.posts_pool.live;
    status->agents = b->registry.present;
    status->lockstep = b->steps.end;
    status->stored = b->pool.mails;
    status->oldest_ns = outcome_oldest_ns(b);
    status->broker = sample_text(b->name);
}

bool broker_part(struct broker *b, uint32_t part, muster_PartStatus *status)
{
    const struct metric *c;
    uint32_t count = 0;
    if (part < 1 || part >= PARTS_END) {
        return false;
    }
    for (size_t i = 0; (c = metrics_at(i)); i++) {
        if (c->part == part) {
            b->part_counters[count++] =
                (muster_Counter){.name = sample_text(c->name), .value = metrics_value(b, c)};
        }
    }
    *status = (muster_PartStatus){.broker = b->name,
                                  .part = b->registry.agents[part].name,
                                  .counters = {count, count, b->part_counters, false}};
    return true;
}

static void line_write(const struct broker *b, uint32_t agent, char to[BROKER_LINE_MAX])
{
    muster_Member m;
    registry_line(&b->registry, agent, b->name, &m);
    struct mu_text t = mu_text_in(to, BROKER_LINE_MAX);
    mu_text_format(&t, "%s %s %s %s %s %s %lu %llu%s%s", m.name, validate_kind_word(m.kind),
                   validate_state_word(m.state), m.broker, m.process[0] ? m.process : "-",
                   m.host[0] ? m.host : "-", (unsigned long)m.pid,
                   (unsigned long long)m.since_wall_ns, m.reason[0] ? " " : "", m.reason);
}

bool broker_page_news(struct broker *b, muster_Page *out)
{
    uint32_t part = registry_next_page(&b->registry);
    if (part == MU_NONE) {
        return false;
    }
    uint32_t first = part * REGISTRY_PAGE, lines = 0;
    for (uint32_t i = first; i < first + REGISTRY_PAGE && i < b->registry.count; i++) {
        if (b->registry.agents[i].name[0] != '\0') {
            line_write(b, i, b->page_text[lines]);
            b->page[lines] = b->page_text[lines];
            lines++;
        }
    }
    *out = (muster_Page){.broker = b->name, .part = part, .lines = {lines, lines, b->page, false}};
    return true;
}

bool broker_event_next(struct broker *b, muster_BrokerEvent *out)
{
    static const char *const kinds[ALERT_KINDS] = {"box-full", "dropped", "over-share", "refused"};
    struct alert event;
    if (!alerts_next(&b->alerts, b->clock.now_ns, &event)) {
        return false;
    }
    *out = (muster_BrokerEvent){.agent = b->registry.agents[event.agent].name,
                                .sender = b->registry.agents[event.sender].name,
                                .count = event.count,
                                .wall_ns = b->clock.wall_ns + event.at_ns};
    out->broker = sample_text(b->name);
    out->kind = sample_text(kinds[event.kind]);
    return true;
}

uint32_t broker_samples_wanted(const struct broker *b)
{
    const struct steps *l = &b->steps;
    bool awaits = b->probes.count == 0 && l->roster_count > l->answered;
    return awaits ? l->roster_count - l->answered : 1;
}
