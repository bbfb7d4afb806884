; SPDX-License-Identifier: Apache-2.0
;
; The global controller of the paper's experiment (section 4.4): an agent without a body that commands the
; robots.  The trust policy must let it: experiments/paper.policy.

(defrule start-up
  (event on-run)
  =>
  (you-do red wander)
  (you-do blue follow red)
  (you-do green follow blue)
  (you-do yellow follow green))
