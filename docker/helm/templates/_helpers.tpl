{{- define "arapd.labels" -}}
app.kubernetes.io/name: arapd
app.kubernetes.io/instance: {{ .Release.Name }}
{{- end }}

{{- define "arapd.careful" -}}
allowPrivilegeEscalation: false
readOnlyRootFilesystem: true
capabilities:
  drop: [ALL]
{{- end }}

{{- define "arapd.redis" -}}
{{- if and .Values.redis.bundled .Values.redis.passwordSecret -}}
{{ fail "redis.passwordSecret is for a Redis of yours; the bundled one has a NetworkPolicy instead" }}
{{- else if .Values.redis.bundled -}}
redis://{{ .Release.Name }}-redis:6379
{{- else -}}
{{ required "redis.url or redis.bundled=true has to say where sessions are kept" .Values.redis.url }}
{{- end -}}
{{- end }}
