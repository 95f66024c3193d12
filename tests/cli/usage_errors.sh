#!/usr/bin/env bash
# A wrong command line is said in one line with exit code 2, before anything is read or written.
source "$(dirname "$0")/lib.bash"

refuses 2 'no command is given; see pentaprism --help'
refuses 2 "there is no command or option 'paint'" paint
refuses 2 "there is no command or option '--verbose'" --verbose
refuses 2 'SCENE is required; see pentaprism render --help' render -o a.exr
refuses 2 '--output is required' render builtin:cubes
refuses 2 "there is no option '--colour'" render builtin:cubes -o a.exr --colour 3
refuses 2 "one argument too many, 'second'" render builtin:cubes second -o a.exr
refuses 2 '--spp: its value is missing' render builtin:cubes -o a.exr --spp
refuses 2 '--spp: it is given more than once' render builtin:cubes -o a.exr --spp 2 --spp 4
refuses 2 'SCENE is required' info
refuses 2 'SCENE is required' verify

# option value what the message names
while read -r option value regex; do
    refuses 2 "$regex" render builtin:cubes -o a.exr "$option" "$value"
done <<'END'
--resolution 640 --resolution: '640'.*WIDTHxHEIGHT
--resolution 0x10 --resolution: 0 is not from 1 to 16384
--resolution 16385x10 --resolution: 16385
--resolution 10x-5 --resolution: -5
--resolution 10x10x10 --resolution
--resolution 99999999999x1 --resolution
--spp 0 --spp: '0'.*from 1 to 4096
--spp 4097 --spp
--spp 1.5 --spp
--spp many --spp
--filter sinc --filter: 'sinc' is not one of box, tent
--crop 1,2,3 --crop.*X0,X1,Y0,Y1
--crop 10,10,0,5 --crop.*nothing is left
--crop 0,1281,0,720 --crop.*out of the 1280x720
--crop -1,5,0,5 --crop
--crop 0.5,5,0,5 --crop.*whole
--exposure bright --exposure
--exposure nan --exposure
--tonemap reinhard --tonemap: 'reinhard' is not one of none, aces, filmic
--background 1,2 --background.*R,G,B
--background 1,nan,0 --background
--background -1,0,0 --background
--focal-length 0 --focal-length
--sensor-width -36 --sensor-width
--fstop 0 --fstop
--fstop -2 --fstop
--fstop nan --fstop: nan is not a finite number
--fstop inf --fstop: inf is not a finite number
--lens-radius -1 --lens-radius
--focus-distance 0 --focus-distance
--focus-pixel 5 --focus-pixel
--focus-pixel 1280,0 --focus-pixel.*outside
--aperture-blades 2 --aperture-blades: 2
--aperture-blades -3 --aperture-blades
--aperture-rotation x --aperture-rotation
--aperture-ratio 0 --aperture-ratio
--focus-range 5,2 --focus-range 5,2: the nearest depth comes first
--focus-range 3 --focus-range.*NEAR,FAR
--focus-range 0,2 --focus-range: 0 is not above 0
--focus-range 1,nan --focus-range
--max-foreground-blur -1 --max-foreground-blur
--tilt 90 --tilt: 90 is not from -89 to 89
--swing nan --swing
--cats-eye 1.6 --cats-eye: 1.6 is not from 0 to 1.5
--aperture-image none.png --aperture-image none.png
--aperture-image lens.jpg --aperture-image lens.jpg: only .exr and .png
--sampler halton --sampler: 'halton' is not one of stratified, sobol, blue-noise, independent
--aperture-roundness 1.1 --aperture-roundness: 1.1 is not from 0 to 1
--shutter -0.5 --shutter
--shutter 1e999 --shutter
--shutter-position middle --shutter-position
--shutter-curve sine --shutter-curve: sine cannot be read
--shutter-curve /dev/zero --shutter-curve: /dev/zero: over 1 MB
--shutter-curve trapezoid:0.1 --shutter-curve.*trapezoid:OPEN,CLOSE
--shutter-curve trapezoid:0.8,0.2 --shutter-curve: times rise
--shutter-curve trapezoid:-1,0.2 --shutter-curve: times rise
--shutter-curve trapezoid:0.1,nan --shutter-curve
--rolling-shutter diagonal --rolling-shutter: 'diagonal' is not one of none, top, bottom, left, right
--rolling-shutter-duration 0.5 --rolling-shutter-duration: nothing rolls
--rolling-shutter-duration -1 --rolling-shutter-duration
--motion-segments 0 --motion-segments
--motion-segments 65 --motion-segments
--fps 0 --fps
--fps -24 --fps
--frame 1.5 frames '1.5'
--frame -1 frames '-1'
--frame 1-3 --frame takes one
--frames 1- frames '1-'
--frames 1-3x0 frames '1-3x0'
--frames 1,1 listed twice
--frames 1-3 3 frames need a place for their number
--culling psychic --culling: 'psychic' is not one of auto
--culling none+psychic --culling: 'psychic' is not one of auto
--culling none+ --culling: '' is not one of auto
--culling none+auto 'auto' stands alone
--culling hull@town --culling hull@town: 'town' is not one of tile, pixel, bucket
--visibility xray --visibility
--backend quantum --backend
--shading never --shading
--seed -1 --seed
--seed 4294967296 --seed
--threads 0 --threads
--threads 1025 --threads
--threads two --threads
--progress bar --progress
--log-level loud --log-level
END

refuses 2 '--fstop and --lens-radius' render builtin:cubes -o a.exr --fstop 2 --lens-radius 0.1
refuses 2 '--focus-distance, --focus-object' render builtin:cubes -o a.exr --focus-distance 2 --focus-object cube
refuses 2 '--frame excludes --frames' render builtin:cubes -o a.exr --frame 2 --frames 3
refuses 2 '--overwrite excludes --skip-existing|--skip-existing excludes --overwrite' \
    render builtin:cubes -o a.exr --overwrite --skip-existing
refuses 2 'must end in .exr or .png' render builtin:cubes -o a.jpg
refuses 2 'must end in .exr or .png' render builtin:cubes -o picture
for option in --output --stats --dataset --samples --aperture-image --camera --focus-object --animation; do
    refuses 2 "$option: its value is empty" render builtin:cubes "$option" ''
done
refuses 2 '--output: its value is empty' render builtin:cubes -o ''
refuses 2 '--report: its value is empty' bench --quick --report ''
refuses 2 '--list excludes|excludes --list' scene cubes -o a.glb --list
refuses 2 '--gain: nan is not a finite number above 0' compare a.exr b.exr -o c.exr --gain nan
refuses 2 '--gain: -1 is not a finite number above 0' compare a.exr b.exr -o c.exr --gain -1
refuses 2 '--resolution' verify builtin:cubes --resolution 0x0
refuses 2 '--target-error: verify looks at --spp' verify builtin:cubes --target-error 0.1
refuses 2 '--stats a.exr: it is the file of the picture itself' render builtin:cubes -o a.exr --stats a.exr
refuses 2 '--stats ./a.#.exr: it is the file of the picture itself' render builtin:cubes -o 'a.#.exr' --stats './a.#.exr' -f 1-2
refuses 2 '--crop: verify looks at whole pictures' verify builtin:cubes --crop 0,8,0,8
refuses 2 '--transparency a-buffer: verify looks at the one surface' verify builtin:cubes --transparency a-buffer
refuses 2 '--time' verify builtin:cubes --time 0

PENTAPRISM_THREADS=lots refuses 2 "PENTAPRISM_THREADS: 'lots'" render builtin:cubes -o a.exr
PENTAPRISM_THREADS=0 refuses 2 'PENTAPRISM_THREADS' render builtin:cubes -o a.exr
PENTAPRISM_ISA=mmx refuses 2 'PENTAPRISM_ISA' render builtin:cubes -o a.exr

check "no file was made" test -z "$(find . -name 'a.*' -print -quit)"
finish
