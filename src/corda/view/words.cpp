#include "corda/view/words.hpp"

#include <algorithm>
#include <cstddef>

namespace corda::view {
namespace {

/// Texts in the order of Language. "{}" stands for a text that is filled in.
constexpr std::string_view kWords = R"(
energy|Energie|energia|energía|énergie
kinetic|kinetisch|cinética|cinética|cinétique
potential|potenziell|potencial|potencial|potentielle
weight|Gewicht|peso|peso|poids
elastic|elastisch|elástica|elástica|élastique
total|gesamt|total|total|totale
energy error|Energiefehler|erro da energia|error de la energía|erreur d’énergie
angle|Winkel|ângulo|ángulo|angle
angular velocity|Winkelgeschwindigkeit|velocidade angular|velocidad angular|vitesse angulaire
distance of the tips|Abstand der Enden|distância das pontas|distancia de los extremos|distance des extrémités
distance|Abstand|distância|distancia|distance
position|Position|posição|posición|position
x of {}|x von {}|x de {}|x de {}|x de {}
rope|Seil|corda|cuerda|corde
net|Netz|rede|red|filet
speed|Geschwindigkeit|velocidade|velocidad|vitesse
tension|Zugkraft|tensão|tensión|tension
strain|Dehnung|deformação|deformación|déformation
error below {} px|Fehler unter {} px|erro abaixo de {} px|error menor de {} px|erreur inférieure à {} px
largest tension|größte Zugkraft|maior tensão|tensión máxima|tension maximale
largest strain|größte Dehnung|maior deformação|deformación máxima|déformation maximale
distance along the rope|Weg entlang des Seils|distância ao longo da corda|distancia a lo largo de la cuerda|distance le long de la corde
{} speed|Tempo {}|velocidade {}|velocidad {}|vitesse {}
theory|Theorie|teoria|teoría|théorie
at rest|in Ruhe|em repouso|en reposo|au repos
Report of {}|Bericht zu {}|Relatório de {}|Informe de {}|Rapport de {}
Setting|Angaben|Dados|Datos|Données
Largest figures, at frame times|Größte Werte, zu den Zeiten der Bilder|Maiores valores, nos tempos dos quadros|Valores máximos, en los tiempos de los fotogramas|Valeurs maximales, aux temps des images
Motion|Bewegung|Movimento|Movimiento|Mouvement
Path|Bahn|Trajetória|Trayectoria|Trajectoire
Path of the tip|Bahn des Endes|Trajetória da ponta|Trayectoria del extremo|Trajectoire de l’extrémité
Angle|Winkel|Ângulo|Ángulo|Angle
Angle over time|Winkel über der Zeit|Ângulo ao longo do tempo|Ángulo en el tiempo|Angle au cours du temps
Phase portrait|Phasenporträt|Retrato de fase|Retrato de fase|Portrait de phase
Energy|Energie|Energia|Energía|Énergie
Energy over time|Energie über der Zeit|Energia ao longo do tempo|Energía en el tiempo|Énergie au cours du temps
Tension|Zugkraft|Tensão|Tensión|Tension
Largest tension over time|Größte Zugkraft über der Zeit|Maior tensão ao longo do tempo|Tensión máxima en el tiempo|Tension maximale au cours du temps
Tension along the rope|Zugkraft entlang des Seils|Tensão ao longo da corda|Tensión a lo largo de la cuerda|Tension le long de la corde
Strain|Dehnung|Deformação|Deformación|Déformation
Largest strain over time|Größte Dehnung über der Zeit|Maior deformação ao longo do tempo|Deformación máxima en el tiempo|Déformation maximale au cours du temps
)";

}  // namespace

std::string translated(std::string_view english, Language language) {
    if (language == Language::kEnglish) return std::string(english);
    // The unit, or the index of a body.
    const std::size_t unit = english.find(" (");
    const std::size_t last = english.find_last_not_of("0123456789");
    const bool is_numbered =
        last != std::string_view::npos && last + 1 < english.size() && english[last] == ' ';
    const std::size_t end = std::min(unit, is_numbered ? last : english.size());
    std::size_t at = kWords.find("\n" + std::string(english.substr(0, end)) + "|");
    if (at == std::string_view::npos) return std::string(english);
    for (int skipped = 0; skipped < static_cast<int>(language); ++skipped) at = kWords.find('|', at) + 1;
    const std::size_t word_end = kWords.find_first_of("|\n", at);
    return std::string(kWords.substr(at, word_end - at)) + std::string(english.substr(end));
}

std::string localized(std::string numbers, Language language) {
    std::ranges::replace(numbers, '.', decimal_sign(language));
    return numbers;
}

std::string translated_name(const System& system, std::size_t body, Language language) {
    const std::string name = body_name(system, body);
    return system.bodies[body].label.empty() ? translated(name, language) : name;
}

}  // namespace corda::view
