#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# build.sh SKETCH OUT: compiles firmware/SKETCH for an Arduino Mega 2560 to OUT/SKETCH.elf and .hex, with the compiler
# and the Arduino core of Debian (gcc-avr, avr-libc, arduino-core-avr).
set -euo pipefail
sketch=$1 out=$2 here=$(dirname "$0")
core=/usr/share/arduino/hardware/arduino/avr/cores/arduino
variant=/usr/share/arduino/hardware/arduino/avr/variants/mega
mkdir -p "$out/$sketch"
# Debian's gcc-avr hides DECIMAL_DIG, which the core needs.
flags=(-mmcu=atmega2560 -DF_CPU=16000000L -DARDUINO=10819 -DARDUINO_AVR_MEGA2560 -DARDUINO_ARCH_AVR
  -DDECIMAL_DIG=__DECIMAL_DIG__ -Os -ffunction-sections -fdata-sections -flto -I"$core" -I"$variant")
objects=()
compile() {  # SOURCE LANGUAGE [FLAG..]
  local object="$out/$sketch/$(basename "$1").o"
  objects+=("$object")
  [ "$object" -nt "$1" ] || avr-gcc -x "$2" -c "$1" -o "$object" "${flags[@]}" "${@:3}"
}
for source in "$core"/*.c; do compile "$source" c -w; done
for source in "$core"/{abi,hooks,main,new,HardwareSerial,HardwareSerial0,HardwareSerial1,Print,Stream,WMath,WString}.cpp; do
  [ ! -e "$source" ] || compile "$source" c++ -std=gnu++11 -fno-exceptions -fno-threadsafe-statics -w
done
compile "$here/$sketch/$sketch.ino" c++ -include Arduino.h -std=gnu++11 -fno-exceptions -fno-threadsafe-statics \
  -Wall -Wextra -Werror
avr-gcc "${flags[@]}" -Wl,--gc-sections -o "$out/$sketch.elf" "${objects[@]}" -lm
avr-objcopy -O ihex -R .eeprom "$out/$sketch.elf" "$out/$sketch.hex"
avr-size "$out/$sketch.elf"
