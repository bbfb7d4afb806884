/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file query.h
 * Questions to the white pages: mails to `broker`, answered by mail.
 *
 *   lookup NAME  ->  inform   member NAME KIND STATE BROKER HOST PID
 *                    failure  unknown-name NAME
 *   listing      ->  inform   members NAME NAME ...   (several mails if they do not fit one)
 *   anything     ->  not-understood
 */
#ifndef MUSTER_BROKER_QUERY_H
#define MUSTER_BROKER_QUERY_H

#include "broker/store.h"

struct broker;

void query_answer(struct broker *b, const struct mail *question);

#endif
