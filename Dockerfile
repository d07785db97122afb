# cloth_sim on a bare Debian 12, from its own packages; nothing else is fetched.
#
#   docker build -t cloth_sim .
#   docker run --rm -v "$PWD/out:/out" cloth_sim             # the demo: /out/demo.{bag,json,png}
#   docker run --rm -it cloth_sim bash                       # a shell in which everything is built
FROM debian:12
WORKDIR /opt/cloth_sim
COPY . .
# Installs what is missing, builds, and tries a short run.
RUN scripts/demo.sh --headless --scene strip --out /tmp && rm -rf /var/lib/apt/lists/* /tmp/demo.*
RUN echo 'source /opt/cloth_sim/.ws/devel/setup.bash' >>/root/.bashrc
CMD ["scripts/demo.sh", "--headless", "--out", "/out"]
