; SPDX-License-Identifier: Apache-2.0
;
; (after SECONDS WORD...): once the time is over, the fact (timeout WORD...) is there, until a rule
; retracts it.  (every SECONDS WORD...) again and again; (cancel WORD...) ends both.  Simulated time,
; looked at in each step.

(deffunction cancel ($?what)
  (progn$ (?timer (findall (timer $?)))
    (if (eq (rest$ (rest$ (fact-fields ?timer))) ?what) then
      (retract ?timer))))

(deffunction after (?seconds $?what)
  (assert (timer (+ (now) ?seconds) 0 $?what)))

(deffunction every (?seconds $?what)
  (assert (timer (+ (now) ?seconds) ?seconds $?what)))

(defrule timer-over
  (declare (salience 50))
  ?timer <- (timer ?at ?again $?what)
  (position ?time&:(>= ?time ?at) $?)
  =>
  (retract ?timer)
  (assert (timeout $?what))
  (if (> ?again 0) then
    (assert (timer (+ ?at ?again) ?again $?what))))
