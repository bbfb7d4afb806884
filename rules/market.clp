; SPDX-License-Identifier: Apache-2.0
;
; What all robots on the market do: they join the group `market`, and stand still.
; rules/shop.clp and rules/buyer.clp extend this.

(deffacts beginning
  (goal stay))

(defrule enter
  (event on-run)
  =>
  (group-join market))

; Groups and services are no facts: a rule that waits for them asks in every step.
(deffunction market-is-open (?size)
  (>= (length$ (members market)) ?size))
