#!/usr/bin/env bash
# Whatever a file holds, `info` either reads it (exit 0) or says in one line why not (exit 3), and soon: no crash, no hang.
set -euo pipefail
[[ -n ${PENTAPRISM_SCENES:-} ]] || { echo "skipped: PENTAPRISM_SCENES is not set"; exit 77; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
files=0 refused=0 wrong=0
while IFS= read -r -d '' file; do
    files=$((files + 1))
    status=0
    timeout 20 "$PENTAPRISM" info "$file" >"$work/out" 2>"$work/err" </dev/null || status=$?
    case $status in
    0) ;;
    3)
        refused=$((refused + 1))
        errors=$(grep -c '^pentaprism: error: ' "$work/err" || true)
        if [[ $errors != 1 ]] || grep -qvE '^pentaprism: (error|warning): ' "$work/err"; then
            wrong=$((wrong + 1))
            echo "$file: not one plain line: $(head -c 300 "$work/err")"
        fi
        ;;
    *)
        wrong=$((wrong + 1))
        echo "$file: exit code $status: $(head -c 2000 "$work/err")"
        ;;
    esac
done < <(find "$PENTAPRISM_SCENES/malformed" "$PENTAPRISM_SCENES/obj" -type f \
    \( -name '*.gltf' -o -name '*.glb' -o -name '*.obj' \) -print0 | sort -z)

echo "$files files, $refused refused, $wrong wrong"
[[ $wrong == 0 && $files -gt 100 && $refused -gt 20 ]]
