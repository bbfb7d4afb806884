; SPDX-License-Identifier: Apache-2.0
;
; The resolver of examples/battery.c in rules: battery:low is whoever offers something with
; battery < 0.3, and battery:0.5 whoever has less than a half.

(defglobal ?*low* = 0.3)

(deffunction by-battery (?rest ?sender)
  (switch ?rest
    (case low then (find-service "*" (str-cat "battery<" ?*low*)))
    (default (if (numberp ?rest) then (find-service "*" (str-cat "battery<" ?rest)) else FALSE))))

(on-resolve battery by-battery)
