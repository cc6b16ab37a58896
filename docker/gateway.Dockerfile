# The web gateway and the studio page, in two stages. From the root of the repository:
#   docker build -f docker/gateway.Dockerfile -t arapd-gateway:local .
# It listens on 0.0.0.0:8080; every flag is an argument or a variable (docs/web.md).
ARG BASE=debian:bookworm-slim
FROM ${BASE} AS build
RUN apt-get -qq update \
 && apt-get -qq -y install --no-install-recommends nodejs npm ca-certificates \
 && rm -rf /var/lib/apt/lists/*
WORKDIR /src
COPY LICENSE LICENSE
COPY proto proto
COPY web web
# The gateway links the client, and the studio is built with tools that do not run here.
RUN for folder in client gateway studio; do \
      (cd web/$folder && npm ci --ignore-scripts --no-audit --no-fund && npm run --silent build) || exit 1; \
    done \
 && for folder in client gateway; do (cd web/$folder && npm prune --omit=dev --ignore-scripts --no-audit --no-fund) || exit 1; done \
 && mkdir -p /out/gateway \
 && cp -a web/gateway/package.json web/gateway/dist web/gateway/node_modules /out/gateway/ \
 && mkdir -p /out/gateway/node_modules/@arapd/client \
 && cp -a web/client/package.json web/client/dist web/client/node_modules /out/gateway/node_modules/@arapd/client/ \
 && cp -a web/studio/dist /out/studio

FROM ${BASE}
RUN apt-get -qq update \
 && apt-get -qq -y install --no-install-recommends nodejs \
 && rm -rf /var/lib/apt/lists/* /var/cache/apt/*.bin /var/log/apt /var/log/dpkg.log
COPY --from=build /out/ /srv/arapd/
COPY LICENSE /usr/share/doc/arapd-gateway/
ENV NODE_ENV=production ARAPD_GATEWAY_LISTEN=0.0.0.0:8080 ARAPD_GATEWAY_STATIC=/srv/arapd/studio
USER 10002:10002
EXPOSE 8080
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=10s --timeout=5s --start-period=10s \
  CMD ["node", "-e", "fetch('http://127.0.0.1:8080/healthz').then((answer) => process.exit(answer.ok ? 0 : 1), () => process.exit(1))"]
ENTRYPOINT ["node", "/srv/arapd/gateway/dist/main.js"]
